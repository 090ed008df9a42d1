// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk_light.h"

#include "core/job/job.h"
#include "worker/model/light_kind.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_light.h"

bool scene_glue_walk_has_near(const struct scene_model *model, size_t i)
{
    return model->features.media_are_lit && model->features.light_is_seen[i] &&
           light_kind_of(&model->job->scene.lights[i])->is_inverse_square;
}

static size_t count_near(const struct scene_model *model)
{
    size_t count = 0;

    for (size_t i = 0; i < model->job->scene.light_count; ++i)
        count += scene_glue_walk_has_near(model, i);
    return count;
}

// Whether the light's transmittance is known at a vertex, without a flight.
static bool is_direct(const struct scene_model *model, size_t i)
{
    const struct scene_features *features = &model->features;

    return !features->tracks_to_lights || (features->has_light_grids && features->light_is_marched[i]);
}

// Whether vertices near lamps are reached without a flight. A light's grid knows nothing of other ways.
static bool near_is_direct(const struct scene_model *model)
{
    return !model->features.tracks_to_lights;
}

static void write_flies(FILE *out, const struct scene_model *model)
{
    bool flies = count_near(model) > 0 && !near_is_direct(model);

    for (size_t i = 0; i < model->job->scene.light_count; ++i)
        flies |= model->features.light_is_seen[i] && !is_direct(model, i);
    fprintf(out, "const bool WALK_FLIES = %s;\n", flies ? "true" : "false");
}

static const char *closed_transmittance(const struct scene_model *model)
{
    return model->features.has_extinction
               ? "media_transmittance(media_column_begin(media_spans(point, direction), distance))"
               : "spectrum(1.0)";
}

// Writes walk_passed, the transmittance along a stretch of a ray where it has a closed form, and walk_reach_I, that
// from a point to a light.
static void write_transmittances(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    const char *wall = features->has_objects ? "    if (walk_wall(point, direction, left).limit < distance) return "
                                               "spectrum(0.0);\n"
                                             : "";

    if (!features->tracks_to_lights)
        fprintf(out,
                "Spectrum walk_passed(vec3 point, uint left, vec3 direction, float distance)\n{\n%s    return %s;\n}\n",
                wall, closed_transmittance(model));
    for (size_t i = 0; i < model->job->scene.light_count; ++i) {
        if (!features->light_is_seen[i] || !is_direct(model, i)) continue;
        fprintf(out, "Spectrum walk_reached_%zu(vec3 point, uint left, LightSample light)\n{\n", i);
        if (!features->tracks_to_lights)
            fputs("    return walk_passed(point, left, light.direction, light.distance);\n}\n", out);
        else
            fprintf(out, "%s    return media_transmittance(light_%zu_column(point, light));\n}\n",
                    features->has_objects
                        ? "    if (walk_wall(point, light.direction, left).limit < light.distance) return "
                          "spectrum(0.0);\n"
                        : "",
                    i);
    }
}

// The reach of a lamp in a medium: a mean free path there, and a fraction of the medium's extent. Outside it is 0.
static void write_reach(FILE *out, const struct scene_model *model, size_t i)
{
    fprintf(
        out,
        "    spans = media_spans(light_%zu_position, vec3(1.0, 0.0, 0.0));\n    extent = 0.0;\n    edge = FAR_AWAY;\n",
        i);
    for (size_t k = 0; k < model->features.medium_count; ++k)
        if (model->features.media[k].scatters)
            fprintf(out,
                    "    if (span_has(spans.medium_%zu, 0.0)) extent = max(extent, spans.medium_%zu.y - "
                    "spans.medium_%zu.x);\n",
                    k, k, k);
    fprintf(out,
            "    rate = media_rate(spans, media_ray(light_%zu_position, vec3(1.0, 0.0, 0.0)), 0.0, 0.0, edge);\n"
            "    walk_reach_%zu = walk_near_reach(extent, rate);\n",
            i, i);
}

static void write_near_find(FILE *out, const struct scene_model *model)
{
    for (size_t i = 0; i < model->job->scene.light_count; ++i)
        if (scene_glue_walk_has_near(model, i)) fprintf(out, "float walk_reach_%zu = 0.0;\n", i);
    fputs("void walk_near_find()\n{\n", out);
    if (count_near(model) > 0) fputs("    MediaSpans spans;\n    float extent, edge, rate;\n", out);
    for (size_t i = 0; i < model->job->scene.light_count; ++i)
        if (scene_glue_walk_has_near(model, i)) write_reach(out, model, i);
    fputs("}\n", out);
}

static bool has_lobe(const struct scene_model *model, size_t i, size_t k)
{
    return model->features.media[i].scatters && model->features.media[i].lobes[k] == LOBE_HENYEY_GREENSTEIN;
}

// Whether what is drawn near a lamp follows lobes. In a spot's beam it has less noise, and takes as much longer.
static bool follows_lobes(const struct scene_model *model, size_t i)
{
    bool has_lobes = false;

    for (size_t m = 0; m < model->features.medium_count; ++m)
        for (size_t k = 0; k < model->job->scene.media[m].lobe_count; ++k)
            has_lobes |= has_lobe(model, m, k);
    return has_lobes && !light_kind_of(&model->job->scene.lights[i])->is_spot;
}

// Writes walk_near_lobe, the g of the narrowest lobe, or 0 where all are wide.
static void write_near_lobe(FILE *out, const struct scene_model *model)
{
    fputs("float walk_near_lobe()\n{\n    float g = 0.0;\n", out);
    for (size_t i = 0; i < model->features.medium_count; ++i)
        for (size_t k = 0; k < model->job->scene.media[i].lobe_count; ++k)
            if (has_lobe(model, i, k))
                fprintf(out, "    if (abs(medium_%zu_lobe_%zu_g) > abs(g)) g = medium_%zu_lobe_%zu_g;\n", i, k, i, k);
    fputs("    return walk_near_followed(g);\n}\n", out);
}

// Writes the line on a ray near a lamp. A spot's is where it shines.
static void write_near_line(FILE *out, const struct scene_model *model, size_t i, const char *direction,
                            const char *interval)
{
    const struct scene_light *light = &model->job->scene.lights[i];

    fprintf(out, "walk_near_line_of(light_%zu_position - point, %s, ", i, direction);
    if (light_kind_of(light)->is_spot) {
        fprintf(out, "span_meet(%s, light_spot_lit(", interval);
        scene_glue_light_write_value(out, light, i);
        fprintf(out, ", point, %s))", direction);
    } else {
        fputs(interval, out);
    }
    fprintf(out, ", walk_reach_%zu, %s)", i, follows_lobes(model, i) ? "walk_near_lobe()" : "0.0");
}

// Writes what is drawn near a lamp from a vertex: from the lamp, and where it follows lobes, every other time in a
// direction that the vertex scatters into.
static void write_near_from(FILE *out, const struct scene_model *model, size_t i)
{
    static const char INTERVAL[] = "vec2(0.0, FAR_AWAY)";
    bool follows = follows_lobes(model, i);
    char lamp[160];

    if (light_kind_of(&model->job->scene.lights[i])->is_spot)
        snprintf(lamp, sizeof lamp,
                 "light_%zu_position - point, walk_reach_%zu, -light_%zu_direction, light_%zu_outer, 0.0", i, i, i, i);
    else
        snprintf(lamp, sizeof lamp,
                 "light_%zu_position - point, walk_reach_%zu, vec3(0.0, 0.0, 1.0), 3.14159265358979324, %s", i, i,
                 follows ? "walk_near_lobe()" : "0.0");
    if (follows) {
        fputs("        bool follows = walk_near_lobe() != 0.0;\n"
              "        if (follows && walk_random() < 0.5) {\n            vec3 on = incoming;\n"
              "            walk_scatter(vertex, incoming, weight, on);\n            near = walk_near_on(",
              out);
        write_near_line(out, model, i, "on", INTERVAL);
        fprintf(out,
                ", on);\n            if (near.weight <= 0.0) return spectrum(0.0);\n"
                "            near.weight = walk_near_from_inverse(near, %s);\n        } else\n    ",
                lamp);
    }
    fprintf(out, "        near = walk_near_from(%s);\n", lamp);
    if (!follows) return;
    // At the lamp itself nothing is known.
    fputs("        if (follows && near.weight > 0.0) {\n"
          "            float phase = spectrum_mean(weight * walk_scattered(vertex, incoming, near.direction)) /\n"
          "                          max(spectrum_mean(weight * walk_scattering(vertex)), 1e-30);\n"
          "            near.weight = walk_near_either(near.weight, walk_near_on_inverse(",
          out);
    write_near_line(out, model, i, "near.direction", INTERVAL);
    fputs(", near.distance), phase);\n        }\n", out);
}

static void write_near_lamp(FILE *out, const struct scene_model *model, size_t i, bool is_start)
{
    fprintf(out, "{\n        if (walk_reach_%zu <= 0.0) return spectrum(0.0);\n", i);
    if (is_start) {
        fputs("        near = walk_near_on(", out);
        write_near_line(out, model, i, "ray.direction", "ray.interval");
        fputs(", ray.direction);\n", out);
    } else {
        write_near_from(out, model, i);
    }
    fprintf(out, "        near.lamp = %zu;\n    }\n", i);
}

// Writes the choice of a lamp, each as likely, and what is drawn near it.
static void write_near_draw(FILE *out, const struct scene_model *model, bool is_start)
{
    size_t index = 0, count = count_near(model);

    if (count > 1) fprintf(out, "    int lamp = min(int(walk_random() * %zu.0), %zu);\n", count, count - 1);
    for (size_t i = 0; i < model->job->scene.light_count; ++i) {
        if (!scene_glue_walk_has_near(model, i)) continue;
        if (count > 1)
            fprintf(out, "    if (lamp == %zu) ", index++);
        else
            fputs("    ", out);
        write_near_lamp(out, model, i, is_start);
    }
    if (count > 1) fprintf(out, "    near.weight *= %zu.0;\n", count);
    fputs("    if (near.weight <= 0.0) return spectrum(0.0);\n", out);
}

// Writes the light of the lamp near which a vertex was drawn.
static void write_lamp(FILE *out, const struct scene_model *model)
{
    bool adds = model->features.media_are_lit && count_near(model) > 0;

    fputs("Spectrum walk_lamp(int lamp, vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, inout "
          "LightSample light, inout Spectrum sum)\n{\n    Spectrum lit = spectrum(0.0);\n    float reach = 1.0;\n"
          "    Spectrum passed = spectrum(0.0);\n",
          out);
    for (size_t i = 0; i < model->job->scene.light_count; ++i) {
        if (!scene_glue_walk_has_near(model, i)) continue;
        fprintf(out, "    if (lamp == %zu) {\n        light = light_%zu(point);\n        reach = walk_reach_%zu;\n", i,
                i, i);
        if (is_direct(model, i)) fprintf(out, "        passed = walk_reached_%zu(point, 0u, light);\n", i);
        fputs("    }\n", out);
    }
    if (adds)
        fputs("    lit = weight * light.irradiance * walk_scattered(vertex, incoming, light.direction) *\n"
              "          walk_near_part(light.distance * light.distance, reach);\n",
              out);
    // Lamps are marched to: all of them have grids, or none.
    if (adds && (near_is_direct(model) || model->features.has_light_grids))
        fputs("    sum += lit * passed;\n    return spectrum(0.0);\n}\n", out);
    else
        fputs("    return lit;\n}\n", out);
}

// Writes the light of a vertex near a lamp that is reached without a flight.
static void write_near_light(FILE *out)
{
    fputs("Spectrum walk_near_light(vec3 point, uint left, WalkNear near, Spectrum weight)\n{\n"
          "    MediaSpans spans = media_spans(point, near.direction);\n"
          "    vec2 stretch = media_interval(spans);\n"
          "    if (near.distance < stretch.x || near.distance >= stretch.y) return spectrum(0.0);\n"
          "    vec3 there = point + near.distance * near.direction;\n"
          "    WalkVertex vertex = walk_vertex(media_field(spans, there, near.direction, near.distance));\n"
          "    LightSample light;\n    Spectrum lit = spectrum(0.0);\n"
          "    walk_lamp(near.lamp, there, near.direction, vertex, weight * walk_passed(point, left, near.direction, "
          "near.distance), light, lit);\n    return lit;\n}\n",
          out);
}

static void write_near_vertex(FILE *out, const struct scene_model *model)
{
    fputs("Spectrum walk_near(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, inout WalkNear near, "
          "inout Spectrum sum)\n{\n",
          out);
    if (count_near(model) == 0) {
        fputs("    return spectrum(0.0);\n}\n", out);
        return;
    }
    write_near_draw(out, model, false);
    fputs("    Spectrum nearby = weight * near.weight * walk_scattered(vertex, incoming, near.direction);\n", out);
    fputs(near_is_direct(model) ? "    sum += walk_near_light(point, vertex.left, near, nearby);\n"
                                  "    return spectrum(0.0);\n}\n"
                                : "    return nearby;\n}\n",
          out);
}

static void write_near_start(FILE *out, const struct scene_model *model)
{
    fputs("Spectrum walk_near_start(WalkRay ray, inout WalkNear near, inout Spectrum sum)\n{\n", out);
    if (count_near(model) == 0) {
        fputs("    return spectrum(0.0);\n}\n", out);
        return;
    }
    fputs("    vec3 point = ray.origin;\n", out);
    write_near_draw(out, model, true);
    // Media before the interval do not count, but surfaces do.
    if (near_is_direct(model) && model->features.has_objects)
        fputs("    if (walk_wall(point, ray.direction, 0u).limit < near.distance) return spectrum(0.0);\n", out);
    fputs(near_is_direct(model)
              ? "    Spectrum nearby = spectrum(near.weight);\n    float begin = max(ray.interval.x, 0.0);\n"
                "    near.distance -= begin;\n"
                "    sum += walk_near_light(point + begin * ray.direction, 0u, near, nearby);\n"
                "    return spectrum(0.0);\n}\n"
              : "    return spectrum(near.weight);\n}\n",
          out);
}

// Writes the sample of a dome. Directions are drawn by the phase functions, every other one of an image's by its light:
// the density is that of both together (Veach and Guibas, SIGGRAPH 1995).
static void write_dome_sample(FILE *out, const struct scene_light *light, size_t i)
{
    bool has_image = light_kind_of(light)->has_image;

    fputs("        vec3 toward = incoming;\n        walk_scatter(vertex, incoming, weight, toward);\n", out);
    if (has_image) fprintf(out, "        if (walk_random() < 0.5) toward = light_%zu_draw();\n", i);
    fputs(
        "        Spectrum share = weight * walk_scattered(vertex, incoming, toward);\n"
        "        float density = spectrum_mean(share) / max(spectrum_mean(weight * walk_scattering(vertex)), 1e-30);\n",
        out);
    if (has_image) fprintf(out, "        density = 0.5 * (density + light_%zu_density(toward));\n", i);
    fprintf(out,
            "        LightSample candidate = LightSample(toward, FAR_AWAY, light_%zu_radiance(toward) / max(density, "
            "1e-30));\n        share *= candidate.irradiance;\n",
            i);
}

static void write_light_sample(FILE *out, const struct scene_model *model, size_t i)
{
    const struct scene_light *light = &model->job->scene.lights[i];

    if (light_kind_of(light)->is_dome) {
        write_dome_sample(out, light, i);
        return;
    }
    fprintf(out, "        LightSample candidate = light_%zu(point);\n", i);
    if (scene_glue_walk_has_near(model, i))
        fprintf(out,
                "        if (walk_reach_%zu > 0.0 && vertex.left == 0u)\n            candidate.irradiance *= 1.0 - "
                "walk_near_part(candidate.distance * candidate.distance, walk_reach_%zu);\n",
                i, i);
    fputs("        // Both directions of travel are reversed here, which leaves the angle between them as it is.\n"
          "        Spectrum share = weight * candidate.irradiance * walk_scattered(vertex, incoming, "
          "candidate.direction);\n",
          out);
}

// Lights whose transmittance is known add up.
static void write_known(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    fprintf(out, "const bool WALK_GATHERS = %s;\n", features->has_light_grids ? "true" : "false");
    fputs("void walk_known(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, inout Spectrum sum)\n{\n",
          out);
    for (size_t i = 0; features->has_lights && i < model->job->scene.light_count; ++i) {
        if (!features->light_is_seen[i] || !is_direct(model, i)) continue;
        fputs("    {\n", out);
        write_light_sample(out, model, i);
        fprintf(out, "        sum += share * walk_reached_%zu(point, vertex.left, candidate);\n    }\n", i);
    }
    fputs("}\n", out);
}

// Of several lights to which flights lead one is drawn by what each would add without shadows: Chao's reservoir of one.
static void write_light(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    size_t flown = 0;

    for (size_t i = 0; i < model->job->scene.light_count; ++i)
        flown += features->light_is_seen[i] && !is_direct(model, i);
    fputs("Spectrum walk_light(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, inout LightSample "
          "light)\n{\n    Spectrum lit = spectrum(0.0);\n",
          out);
    if (flown > 1) fputs("    float total = 0.0;\n", out);
    for (size_t i = 0; features->has_lights && i < model->job->scene.light_count; ++i) {
        if (!features->light_is_seen[i] || is_direct(model, i)) continue;
        fputs("    {\n", out);
        write_light_sample(out, model, i);
        fputs(flown > 1 ? "        float mean = spectrum_mean(share);\n        total += mean;\n"
                          "        if (mean > 0.0 && walk_random() * total <= mean) {\n"
                          "            lit = share / mean;\n            light = candidate;\n        }\n    }\n"
                        : "        lit = share;\n        light = candidate;\n    }\n",
              out);
    }
    if (flown > 1) fputs("    lit *= total;\n", out);
    fputs("    return lit;\n}\n", out);
}

void scene_glue_write_walk_lights(FILE *out, const struct scene_model *model)
{
    write_flies(out, model);
    if (model->features.has_lights) write_transmittances(out, model);
    write_near_lobe(out, model);
    write_near_find(out, model);
    write_lamp(out, model);
    if (count_near(model) > 0 && near_is_direct(model)) write_near_light(out);
    write_near_vertex(out, model);
    write_near_start(out, model);
    write_known(out, model);
    write_light(out, model);
}
