// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk.h"

#include "core/job/job.h"
#include "worker/model/light_kind.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_light.h"
#include "worker/shader/scene_glue_media.h"

// Writes the sum of "medium_I_NAME * density" over media of which `applies` is true.
static void write_sum(FILE *out, const struct scene_model *model, const char *name,
                      bool applies(const struct medium_features *medium))
{
    const struct scene_features *features = &model->features;

    fprintf(out, "Spectrum walk_%s(MediaField field)\n{\n    Spectrum sum = spectrum(0.0);\n",
            applies == medium_features_have_column ? "extinction" : "scattering");
    for (size_t i = 0; i < features->medium_count; ++i) {
        if (!applies(&features->media[i])) continue;
        fprintf(out, "    sum += medium_%zu_%s * (", i, name);
        scene_glue_write_density(out, model, i);
        fputs(");\n", out);
    }
    fputs("    return sum;\n}\n", out);
}

static bool scatters(const struct medium_features *medium)
{
    return medium->scatters;
}

static void write_emission(FILE *out, const struct scene_model *model)
{
    fputs("Spectrum walk_emission(MediaField field, vec3 point)\n{\n    Spectrum sum = spectrum(0.0);\n", out);
    for (size_t i = 0; i < model->features.medium_count; ++i) {
        const struct medium_features *medium = &model->features.media[i];

        if (!medium->emits && !medium->has_color && !medium->glows) continue;
        fprintf(out, "    float density_%zu = ", i);
        scene_glue_write_density(out, model, i);
        fputs(";\n", out);
        if (medium->emits) fprintf(out, "    sum += medium_%zu_emission * density_%zu;\n", i, i);
        if (medium->has_color) fprintf(out, "    sum += medium_%zu_color(field.medium_%zu) * density_%zu;\n", i, i, i);
        if (medium->glows) fprintf(out, "    sum += medium_%zu_glow(point) * density_%zu;\n", i, i);
    }
    fprintf(out, "    return sum;\n}\nfloat walk_least(float length)\n{\n    return %s;\n}\n",
            model->features.has_emission ? "TRACKING_SAMPLES / max(length, 1e-30)" : "0.0");
}

// Writes what scatters at a vertex: a surface's share of irradiance, or the media's coefficients, all together.
static void write_scattered(FILE *out, const struct scene_model *model)
{
    bool has_objects = model->features.has_objects;

    fprintf(out, "Spectrum walk_scattering(WalkVertex vertex)\n{\n    return %swalk_scattering(vertex.field);\n}\n",
            has_objects ? "vertex.left != 0u ? vertex.albedo : " : "");
    fputs("Spectrum walk_scattered(WalkVertex vertex, vec3 incoming, vec3 outgoing)\n{\n"
          "    MediaField field = vertex.field;\n    Spectrum sum = spectrum(0.0);\n",
          out);
    if (has_objects)
        fputs("    if (vertex.left != 0u) return vertex.albedo * (4.0 * INV_4PI * max(dot(vertex.normal, outgoing), "
              "0.0));\n",
              out);
    for (size_t i = 0; i < model->features.medium_count; ++i) {
        if (!model->features.media[i].scatters) continue;
        fprintf(out, "    sum += medium_%zu_sigma_s * (", i);
        scene_glue_write_density(out, model, i);
        fprintf(out, " * medium_%zu_phase(incoming, outgoing));\n", i);
    }
    fputs("    return sum;\n}\n", out);
}

static bool has_near(const struct scene_model *model, size_t i)
{
    return model->features.media_are_lit && model->features.light_is_seen[i] &&
           light_kind_of(&model->job->scene.lights[i])->is_inverse_square;
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
            "    rate = media_rate(spans, light_%zu_position, vec3(1.0, 0.0, 0.0), 0.0, 0.0, edge);\n"
            "    walk_reach_%zu = walk_near_reach(extent, rate);\n",
            i, i);
}

static void write_near_find(FILE *out, const struct scene_model *model, size_t count)
{
    for (size_t i = 0; i < model->job->scene.light_count; ++i)
        if (has_near(model, i)) fprintf(out, "float walk_reach_%zu = 0.0;\n", i);
    fputs("void walk_near_find()\n{\n", out);
    if (count > 0) fputs("    MediaSpans spans;\n    float extent, edge, rate;\n", out);
    for (size_t i = 0; i < model->job->scene.light_count; ++i)
        if (has_near(model, i)) write_reach(out, model, i);
    fputs("}\n", out);
}

// Writes what is drawn near a lamp: on a ray, or about the lamp. A spot's is where it shines.
static void write_near_lamp(FILE *out, const struct scene_model *model, size_t i, bool is_start)
{
    const struct scene_light *light = &model->job->scene.lights[i];
    bool is_spot = light_kind_of(light)->is_spot;

    fprintf(out, "{\n        if (walk_reach_%zu <= 0.0) return spectrum(0.0);\n", i);
    if (is_start && is_spot) {
        fputs("        vec2 lit = span_meet(ray.interval, light_spot_lit(", out);
        scene_glue_light_write_value(out, light, i);
        fputs(", point, ray.direction));\n", out);
    }
    fprintf(out, "        near = walk_near_%s(light_%zu_position - point, ",
            is_start  ? "on"
            : is_spot ? "in_cone"
                      : "about",
            i);
    if (is_start)
        fprintf(out, "ray.direction, %s, walk_reach_%zu", is_spot ? "lit" : "ray.interval", i);
    else if (is_spot)
        fprintf(out, "walk_reach_%zu, -light_%zu_direction, light_%zu_outer", i, i, i);
    else
        fprintf(out, "walk_reach_%zu, 3.14159265358979324", i);
    fprintf(out, ");\n        near.lamp = %zu;\n    }\n", i);
}

// Writes the choice of a lamp, each as likely, and what is drawn near it.
static void write_near_draw(FILE *out, const struct scene_model *model, size_t count, bool is_start)
{
    size_t index = 0;

    if (count > 1) fprintf(out, "    int lamp = min(int(walk_random() * %zu.0), %zu);\n", count, count - 1);
    for (size_t i = 0; i < model->job->scene.light_count; ++i) {
        if (!has_near(model, i)) continue;
        if (count > 1)
            fprintf(out, "    if (lamp == %zu) ", index++);
        else
            fputs("    ", out);
        write_near_lamp(out, model, i, is_start);
    }
    if (count > 1) fprintf(out, "    near.weight *= %zu.0;\n", count);
}

static void write_near(FILE *out, const struct scene_model *model)
{
    size_t count = 0;

    for (size_t i = 0; i < model->job->scene.light_count; ++i)
        count += has_near(model, i);
    write_near_find(out, model, count);
    fputs("Spectrum walk_near(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, inout WalkNear near)\n{\n",
          out);
    if (count > 0) {
        write_near_draw(out, model, count, false);
        fputs("    if (near.weight <= 0.0) return spectrum(0.0);\n"
              "    return weight * near.weight * walk_scattered(vertex, incoming, near.direction);\n}\n",
              out);
    } else {
        fputs("    return spectrum(0.0);\n}\n", out);
    }
    fputs("Spectrum walk_near_start(WalkRay ray, inout WalkNear near)\n{\n", out);
    if (count > 0) {
        fputs("    vec3 point = ray.origin;\n", out);
        write_near_draw(out, model, count, true);
    }
    fprintf(out, "    return spectrum(%s);\n}\n", count > 0 ? "max(near.weight, 0.0)" : "0.0");
}

static void write_passed(FILE *out, const struct scene_model *model)
{
    bool is_closed = model->features.has_lights && model->features.has_extinction && !model->features.tracks_to_lights;

    fprintf(
        out,
        "const bool WALK_TRACKS = %s;\nSpectrum walk_passed(MediaSpans spans, float distance)\n{\n    return %s;\n}\n",
        is_closed ? "false" : "true",
        is_closed ? "media_transmittance(media_column_begin(spans, distance))" : "spectrum(1.0)");
}

// Writes the light of the lamp near which a vertex was drawn.
static void write_lamp(FILE *out, const struct scene_model *model)
{
    fputs(
        "Spectrum walk_lamp(int lamp, vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, inout LightSample "
        "light)\n{\n    Spectrum lit = spectrum(0.0);\n    float reach = 1.0;\n",
        out);
    for (size_t i = 0; i < model->job->scene.light_count; ++i)
        if (has_near(model, i))
            fprintf(
                out,
                "    if (lamp == %zu) {\n        light = light_%zu(point);\n        reach = walk_reach_%zu;\n    }\n",
                i, i, i);
    if (model->features.media_are_lit)
        fputs("    lit = weight * light.irradiance * walk_scattered(vertex, incoming, light.direction) *\n"
              "          walk_near_part(light.distance * light.distance, reach);\n",
              out);
    fputs("    return lit;\n}\n", out);
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
    if (has_near(model, i))
        fprintf(out,
                "        if (walk_reach_%zu > 0.0 && vertex.left == 0u)\n            candidate.irradiance *= 1.0 - "
                "walk_near_part(candidate.distance * candidate.distance, walk_reach_%zu);\n",
                i, i);
    fputs("        // Both directions of travel are reversed here, which leaves the angle between them as it is.\n"
          "        Spectrum share = weight * candidate.irradiance * walk_scattered(vertex, incoming, "
          "candidate.direction);\n",
          out);
}

// One of several lights is drawn by what each would add without shadows: Chao's reservoir of one.
static void write_light(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    bool has_several = scene_features_count_lights(features) > 1, is_lit = features->has_lights;

    fputs(
        "Spectrum walk_light(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, inout LightSample light)\n"
        "{\n    Spectrum lit = spectrum(0.0);\n",
        out);
    if (has_several && is_lit) fputs("    float total = 0.0;\n", out);
    for (size_t i = 0; is_lit && i < model->job->scene.light_count; ++i) {
        if (!features->light_is_seen[i]) continue;
        fputs("    {\n", out);
        write_light_sample(out, model, i);
        fputs(has_several ? "        float mean = spectrum_mean(share);\n        total += mean;\n"
                            "        if (mean > 0.0 && walk_random() * total <= mean) {\n"
                            "            lit = share / mean;\n            light = candidate;\n        }\n    }\n"
                          : "        lit = share;\n        light = candidate;\n    }\n",
              out);
    }
    if (has_several && is_lit) fputs("    lit *= total;\n", out);
    fputs("    return lit;\n}\n", out);
}

static void write_lobe(FILE *out, const struct scene_model *model, size_t i, size_t k)
{
    switch (model->features.media[i].lobes[k]) {
    case LOBE_RAYLEIGH:
        fputs("less = scatter_rayleigh(share);", out);
        break;
    case LOBE_HENYEY_GREENSTEIN:
        fprintf(out, "less = scatter_henyey_greenstein(medium_%zu_lobe_%zu_g, share);", i, k);
        break;
    default:
        fputs("less = 2.0 * share;", out);
    }
}

// Writes the choice of a lobe by its weight, and of the angle.
static void write_lobes(FILE *out, const struct scene_model *model, size_t i)
{
    const struct scene_medium *medium = &model->job->scene.media[i];
    size_t count = 0;

    for (size_t k = 0; k < medium->lobe_count; ++k)
        count += model->features.media[i].lobes[k] != LOBE_UNSEEN;
    if (count == 0) fputs("        less = 2.0 * share;\n", out);
    if (count > 1) fputs("        float lobe = walk_random();\n", out);
    for (size_t k = 0; k < medium->lobe_count; ++k) {
        if (model->features.media[i].lobes[k] == LOBE_UNSEEN) continue;
        fputs("        ", out);
        if (count > 1) fputs("if (lobe >= 0.0) { ", out);
        write_lobe(out, model, i, k);
        if (count > 1) fprintf(out, " lobe -= medium_%zu_lobe_%zu_weight; }", i, k);
        fputs("\n", out);
    }
}

// A medium is drawn by its share of what the path's weight leaves behind.
static void write_scatter(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    size_t count = 0;

    for (size_t i = 0; i < features->medium_count; ++i)
        count += features->media[i].scatters;
    fputs("Spectrum walk_scatter(WalkVertex vertex, vec3 incoming, Spectrum weight, out vec3 outgoing)\n{\n"
          "    MediaField field = vertex.field;\n",
          out);
    if (features->has_objects)
        fputs("    outgoing = vertex.normal;\n    if (vertex.left != 0u) {\n"
              "        outgoing = walk_scatter_wall(vertex.normal);\n        return weight * vertex.albedo;\n    }\n",
              out);
    fputs("    float share = walk_random();\n    float less = 0.0;\n    Spectrum behind = spectrum(0.0);\n", out);
    if (count > 1) fputs("    float total = 0.0;\n    int chosen = -1;\n", out);
    for (size_t i = 0; i < features->medium_count; ++i) {
        if (!features->media[i].scatters) continue;
        fprintf(out, "    Spectrum part_%zu = weight * medium_%zu_sigma_s * (", i, i);
        scene_glue_write_density(out, model, i);
        fputs(");\n", out);
        if (count > 1)
            fprintf(out,
                    "    float mean_%zu = spectrum_mean(part_%zu);\n    total += mean_%zu;\n"
                    "    if (mean_%zu > 0.0 && walk_random() * total <= mean_%zu) {\n"
                    "        chosen = %zu;\n        behind = part_%zu / mean_%zu;\n    }\n",
                    i, i, i, i, i, i, i, i);
        else
            fprintf(out, "    behind = part_%zu;\n", i);
    }
    if (count > 1) fputs("    behind *= total;\n", out);
    for (size_t i = 0; i < features->medium_count; ++i) {
        if (!features->media[i].scatters) continue;
        if (count > 1)
            fprintf(out, "    if (chosen == %zu) {\n", i);
        else
            fputs("    {\n", out);
        write_lobes(out, model, i);
        fputs("    }\n", out);
    }
    fputs("    outgoing = scatter_turn(incoming, less, walk_random());\n    return behind;\n}\n", out);
}

enum {
    FLIGHTS = 4,             // in a turn
    CELLS = 8,               // of the majorant, in a flight
    ITERATION_LIMIT = 60000, // a little below what software GL runs
    CODE_LOOPS = 40          // in a look at a user's code, which may have any number
};

// Returns how many iterations of loops a flight takes, with those of a look at the media and of looks for majorants.
static int count_loops(const struct scene_model *model)
{
    int look = 1, cell = 1;

    for (size_t i = 0; i < model->features.medium_count; ++i) {
        const struct scene_density *density = &model->job->scene.media[i].density;

        if (!model->features.media[i].is_seen) continue;
        if (density->kind == SCENE_DENSITY_NOISE) look += density->noise.octaves;
        if (density->kind == SCENE_DENSITY_GLSL) look += CODE_LOOPS;
        if (density->kind != SCENE_DENSITY_FOLD_FRACTAL) continue;
        look += density->fold_fractal.iterations;
        cell += density->fold_fractal.iterations;
    }
    return look + CELLS * cell;
}

// A flight to a light may go on for three times as many turns.
static void write_limits(FILE *out, const struct scene_model *model)
{
    int turns = ITERATION_LIMIT / 3 / (1 + FLIGHTS * count_loops(model));

    fprintf(out,
            "const int WALK_FLIGHTS = %d;\nconst int WALK_CELLS = %d;\nconst int WALK_TURNS = %d;\n"
            "const bool WALK_IS_LAYER = %s;\n",
            FLIGHTS, CELLS, turns > 1 ? turns : 1, model->features.is_scattered ? "true" : "false");
}

void scene_glue_write_walk(FILE *out, const struct scene_model *model)
{
    write_limits(out, model);
    write_sum(out, model, "sigma_t", medium_features_have_column);
    write_sum(out, model, "sigma_s", scatters);
    write_emission(out, model);
    if (model->features.has_lights) write_scattered(out, model);
    write_passed(out, model);
    write_near(out, model);
    write_lamp(out, model);
    write_scatter(out, model);
    write_light(out, model);
}

void scene_glue_write_walk_start(FILE *out)
{
    fputs("WalkRay walk_camera;\nuvec2 walk_pixel;\n"
          "WalkRay walk_start(int path)\n{\n"
          "    walk_random_start(walk_pixel, uint(path), uint(sample_index), uint(frame_seed));\n"
          "    return walk_camera;\n}\n",
          out);
}
