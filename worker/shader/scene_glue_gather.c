// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_gather.h"

#include "core/job/job.h"
#include "worker/glsl/gauss_legendre.h"
#include "worker/model/light_kind.h"
#include "worker/model/scene_model.h"
#include "worker/shader/integrators.h"
#include "worker/shader/scene_glue_light.h"
#include "worker/shader/scene_glue_media.h"
#include "worker/shader/scene_glue_steps.h"

static void write_gathered(FILE *out, const struct scene_model *model)
{
    bool has_objects = model->features.has_objects;

    fputs("// Sums along a ray so far.\nstruct Gathered {\n    Spectrum radiance;\n", out);
    if (model->features.has_throughput) fputs("    Spectrum transmittance;\n", out);
    if (model->features.has_extinction && model->features.has_depth)
        fputs("    float depth; // distance; 0: none yet, negative: not wanted\n", out);
    if (has_objects) fputs("    float least; // the ray is over below this throughput\n", out);
    if (has_objects && model->features.media_are_lit) fputs("    int region; // that contains the ray\n", out);
    fputs("};\nbool gathered_is_over(Gathered gathered)\n{\n", out);
    if (!model->features.has_throughput)
        fputs("    return false;\n}\n", out);
    else if (model->features.is_tracked) // an estimate may be negative
        fputs("    return spectrum_max(abs(gathered.transmittance)) <= 0.0;\n}\n", out);
    else // where the least is 0, too: rays end where nothing passes
        fprintf(out, "    return spectrum_max(gathered.transmittance) <= %s;\n}\n",
                has_objects ? "gathered.least" : "quality_min_transmittance");
}

static void write_column(FILE *out, const struct scene_model *model, const char *spans, const char *distance)
{
    const struct integrator_part *part = integrator_to_lights(model);

    if (!model->features.marches_to_lights) {
        fprintf(out, "%s%s, %s)", part->call, spans, distance);
        return;
    }
    integrator_write_call(out, part, model);
    fprintf(out, ", %s, point, light.direction, %s)", spans, distance);
}

void scene_glue_write_transmittance(FILE *out, const struct scene_model *model, const char *spans, const char *distance)
{
    bool takes_steps = model->features.estimates_columns && !model->features.has_majorants;

    if (model->features.is_tracked) {
        fprintf(out, "media_transmittance_estimate(%s, point, light.direction, vec2(0.0, %s), %s)", spans, distance,
                takes_steps ? "quality_light_step" : "0.0");
        return;
    }
    fputs("media_transmittance(", out);
    write_column(out, model, spans, distance);
    fputs(")", out);
}

// Writes the expression of the transmittance from a light to `position`, in the segment's region.
static void write_shadow(FILE *out, const struct scene_model *model, const char *position)
{
    fprintf(out, "shadow(%s, light, ", position);
    if (model->features.has_dielectrics)
        fputs("surface_set(gathered.region), 0u)", out);
    else
        fputs("0u, 0u)", out);
}

void scene_glue_write_scattered(FILE *out, const char *indent, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    const char *separator = "";

    fprintf(out, "%s// Both directions of travel are reversed here, which leaves the angle between them as it is.\n",
            indent);
    fprintf(out, "%sSpectrum scattered = ", indent);
    for (size_t i = 0; i < features->medium_count; ++i) {
        if (!features->media[i].scatters) continue;
        fprintf(out, "%smedium_%zu_sigma_s * (density_%zu * medium_%zu_phase(light.direction, direction))", separator,
                i, i, i);
        separator = " + ";
    }
    fputs(";\n", out);
}

// Writes the light that arrives at `position` already scattered, and is scattered once more.
static void write_scattered_again(FILE *out, const char *indent, const struct scene_model *model, const char *position)
{
    for (size_t i = 0; i < model->features.medium_count; ++i)
        if (model->features.media[i].scatters)
            fprintf(out, "%ssource += medium_%zu_sigma_s * (density_%zu * medium_%zu_scattered(%s));\n", indent, i, i,
                    i, position);
}

// Each light's columns are in a grid of its own.
static void write_cached_scattering(FILE *out, const struct scene_model *model)
{
    for (size_t i = 0; i < model->job->scene.light_count; ++i) {
        if (!model->features.light_is_marched[i]) continue;
        fputs("    {\n", out);
        fputs("        LightSample light = ", out);
        scene_glue_light_write_sample(out, model, i);
        scene_glue_write_scattered(out, "        ", model);
        fprintf(out,
                "        source += scattered * light.irradiance * media_transmittance(light_%zu_column(point, "
                "light));\n    }\n",
                i);
    }
}

static bool has_spots(const struct scene_model *model)
{
    bool found = false;

    for (size_t i = 0; i < model->job->scene.light_count; ++i)
        found |= model->features.light_is_marched[i] && light_kind_of(&model->job->scene.lights[i])->is_spot;
    return found;
}

// One loop over the lights compiles the march to them once: drivers copy functions to where they are called. Outside of
// a spot's cone there is no march.
static void write_scattering(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    size_t count = scene_features_count_marched(features), iteration = 0;
    bool is_loop = count > 1 || has_spots(model);

    if (is_loop)
        fprintf(out, "    for (int iteration = 0; iteration < %zu; ++iteration) {\n        LightSample light;\n",
                count);
    else
        fputs("    {\n", out);
    for (size_t i = 0; i < model->job->scene.light_count; ++i) {
        if (!features->light_is_marched[i]) continue;
        if (is_loop)
            fprintf(out, "        if (iteration == %zu) light = ", iteration++);
        else
            fputs("        LightSample light = ", out);
        scene_glue_light_write_sample(out, model, i);
    }
    if (has_spots(model)) fputs("        if (spectrum_max(light.irradiance) <= 0.0) continue;\n", out);
    scene_glue_write_scattered(out, "        ", model);
    if (features->has_objects) {
        fputs("        source += scattered * light.irradiance * ", out);
        write_shadow(out, model, "point");
        fputs(";\n    }\n", out);
        return;
    }
    fputs("        source += scattered * light.irradiance * ", out);
    scene_glue_write_transmittance(out, model, "media_spans(point, light.direction)", "light.distance");
    fputs(";\n    }\n", out);
}

// Writes where points are placed for light `i`. Where the transmittance is tiny, and where a spot does not shine, there
// are none. A spot's stretch begins at `entry`, after `lit.x` metres.
static void begin_light_placement(FILE *out, const struct scene_light *light, size_t i)
{
    if (light_kind_of(light)->is_spot) {
        fputs("        vec2 lit = clamp(light_spot_lit(", out);
        scene_glue_light_write_value(out, light, i);
        fprintf(
            out,
            ", start, direction), 0.0, seen);\n"
            "        vec3 entry = start + lit.x * direction;\n"
            "        PlacementAngle placement = placement_angle(light_%zu_position - entry, direction, lit.y - lit.x, "
            "spectrum_min(sigma_t));\n",
            i);
    } else if (light_kind_of(light)->is_inverse_square) {
        fprintf(out,
                "        PlacementAngle placement = placement_angle(light_%zu_position - start, direction, seen, "
                "spectrum_min(sigma_t));\n",
                i);
    } else {
        fputs(
            "        PlacementTransmittance placement = PlacementTransmittance(spectrum_min(sigma_t) * seen, seen);\n",
            out);
    }
    fprintf(out, "        Spectrum sum = spectrum(0.0);\n        for (int i = 0; i < %s; ++i) {\n",
            light_kind_of(light)->is_spot ? "(lit.x < lit.y ? count : 0)" : "count");
}

// Writes the light along the whole segment from points placed for this light.
static void write_placed_scattering(FILE *out, const struct scene_light *light, const struct scene_model *model,
                                    size_t i)
{
    bool is_by_angle = light_kind_of(light)->is_inverse_square, is_spot = light_kind_of(light)->is_spot;

    fputs("    {\n", out);
    begin_light_placement(out, light, i);
    fprintf(out, "            Placed placed = placement_%s_at(placement, placed_share(i));\n",
            is_by_angle ? "angle" : "transmittance");
    fprintf(out,
            "            vec3 position = %s + placed.at * direction;\n"
            "            LightSample light = light_%zu(position);\n",
            is_spot ? "entry" : "start", i);
    scene_glue_write_scattered(out, "            ", model);
    if (model->features.has_objects) {
        fputs("            Spectrum light_transmittance = ", out);
        write_shadow(out, model, "position");
    } else {
        fputs("            MediaColumn column = transmittance_closed(media_spans(position, light.direction), "
              "light.distance);\n            Spectrum light_transmittance = media_transmittance(column)",
              out);
    }
    fprintf(out, " * exp(-sigma_t * %s);\n            sum += scattered * light_transmittance * ",
            is_spot ? "(lit.x + placed.at)" : "placed.at");
    if (is_spot) {
        fputs("light_spot_share(", out);
        scene_glue_light_write_value(out, light, i);
        fputs(", light.direction) * ", out);
    }
    fprintf(out,
            "(placed_weight(i) * placed.weight);\n        }\n"
            "        gathered.radiance += passed * light_%zu_intensity * sum;\n    }\n",
            i);
}

// Writes the light along the whole segment that was scattered before.
static void write_placed_again(FILE *out, const struct scene_model *model)
{
    fputs("    {\n        PlacementTransmittance placement = PlacementTransmittance(spectrum_min(sigma_t) * seen, "
          "seen);\n"
          "        Spectrum sum = spectrum(0.0);\n        for (int i = 0; i < count; ++i) {\n"
          "            Placed placed = placement_transmittance_at(placement, placed_share(i));\n"
          "            vec3 position = start + placed.at * direction;\n            Spectrum source = spectrum(0.0);\n",
          out);
    write_scattered_again(out, "            ", model, "position");
    fputs("            sum += source * exp(-sigma_t * placed.at) * (placed_weight(i) * placed.weight);\n        }\n"
          "        gathered.radiance += passed * sum;\n    }\n",
          out);
}

// Writes the stretch in which points are placed: the whole one, or each piece of it.
static void begin_placed(FILE *out, const struct scene_features *features)
{
    // Beyond this optical depth the transmittance is below 2e-9.
    fputs("    float seen = min(length, 20.0 / max(spectrum_min(sigma_t), 1e-30));\n", out);
    if (!features->extinction_is_rgb) {
        fputs("    vec3 start = point;\n    Spectrum passed = gathered.transmittance;\n", out);
        return;
    }
    fputs("    vec3 ends = placement_cut(sigma_t, seen);\n    float begin = 0.0;\n"
          "    for (int piece = 0; piece < 3; begin = ends[piece], ++piece) {\n"
          "        seen = ends[piece] - begin;\n        if (count == 0 || seen <= 0.0) continue;\n"
          "        vec3 start = point + begin * direction;\n"
          "        Spectrum passed = gathered.transmittance * exp(-sigma_t * begin);\n",
          out);
}

static void write_all_placed(FILE *out, const struct scene *scene, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    const char *separator = "";

    // Outside of media, and in media that only absorb, no light is gathered.
    fputs("    int count = ", out);
    for (size_t i = 0; i < features->medium_count; ++i) {
        if (!features->media[i].scatters) continue;
        fprintf(out, "%sdensity_%zu", separator, i);
        separator = " + ";
    }
    fputs(" > 0.0 ? PLACED_COUNT : 0;\n", out);
    begin_placed(out, features);
    for (size_t i = 0; i < scene->light_count; ++i)
        if (features->light_is_marched[i]) write_placed_scattering(out, &scene->lights[i], model, i);
    if (features->has_scatter_grid) write_placed_again(out, model);
    if (features->extinction_is_rgb) fputs("    }\n", out);
}

static void write_sigma_t(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    const char *separator = "";

    fputs("    Spectrum sigma_t = ", out);
    for (size_t i = 0; i < features->medium_count; ++i) {
        if (!medium_features_have_column(&features->media[i])) continue;
        fprintf(out, "%smedium_%zu_sigma_t * density_%zu", separator, i, i);
        separator = " + ";
    }
    fputs(";\n", out);
}

static void write_left(FILE *out, const struct scene_model *model)
{
    if (model->features.has_roulette)
        fputs("    gathered.transmittance = integrator_roulette(IntegratorRoulette(quality_roulette_below, "
              "quality_roulette_survive), after);\n",
              out);
    else
        fputs("    gathered.transmittance = after;\n", out);
}

// Writes how the transmittance changes over a segment of `length`: `after` is its value behind it.
static void write_passed(FILE *out, const struct scene_model *model)
{
    if (model->features.has_depth)
        fprintf(out,
                "    if (spectrum_mean(gathered.transmittance) > 0.5 && spectrum_mean(after) <= 0.5%s)\n"
                "        gathered.depth = at + depth_half(gathered.transmittance, sigma_t, length);\n",
                model->features.has_roulette || model->features.has_paths ? " && gathered.depth == 0.0" : "");
    write_left(out, model);
}

static void write_extinction(FILE *out, const struct scene_model *model, bool has_source)
{
    bool is_riemann = model->job->quality.method == JOB_METHOD_RIEMANN;

    if (!is_riemann) fputs("    Segment part = segment(sigma_t * length);\n", out);
    if (has_source)
        fprintf(out, "    gathered.radiance += gathered.transmittance * source * %slength;\n",
                is_riemann ? "" : "part.escape * ");
    fprintf(out, "    Spectrum after = gathered.transmittance * %s;\n",
            is_riemann ? "exp(-sigma_t * length)" : "part.transmittance");
    write_passed(out, model);
}

static void write_source(FILE *out, const struct medium_features *medium, size_t i)
{
    if (medium->emits) fprintf(out, "    source += medium_%zu_emission * density_%zu;\n", i, i);
    if (medium->has_color) fprintf(out, "    source += medium_%zu_color(field.medium_%zu) * density_%zu;\n", i, i, i);
    if (medium->glows) fprintf(out, "    source += medium_%zu_glow(point) * density_%zu;\n", i, i);
}

void scene_glue_write_emitted(FILE *out, const struct scene_model *model)
{
    for (size_t i = 0; i < model->job->scene.medium_count; ++i)
        write_source(out, &model->features.media[i], i);
}

static void write_sources(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    fputs("    Spectrum source = spectrum(0.0);\n", out);
    scene_glue_write_emitted(out, model);
    if (features->has_scatter_grid && !features->places_points) write_scattered_again(out, "    ", model, "point");
    if (!features->media_are_lit || features->places_points) return;
    if (features->has_light_grids)
        write_cached_scattering(out, model);
    else
        write_scattering(out, model);
}

void scene_glue_write_densities(FILE *out, const struct scene_model *model)
{
    for (size_t i = 0; i < model->job->scene.medium_count; ++i)
        if (model->features.media[i].is_seen) {
            fprintf(out, "    float density_%zu = ", i);
            scene_glue_write_density(out, model, i);
            fputs(";\n", out);
        }
}

// Writes extinction and source at a node of a segment, per metre.
static void write_gather_node(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    fputs("void gather_node(Gathered gathered, MediaField field, vec3 point, vec3 direction, float length, float "
          "offset, out Spectrum extinction, out Spectrum light_source)\n{\n"
          "    extinction = spectrum(0.0);\n    light_source = spectrum(0.0);\n"
          "    if (field.distance >= 0.0) return;\n",
          out);
    scene_glue_write_densities(out, model);
    if (features->has_emission || features->media_are_lit || features->has_scatter_grid) {
        write_sources(out, model);
        fputs("    light_source = source;\n", out);
    }
    if (features->has_extinction) {
        write_sigma_t(out, model);
        fputs("    extinction = sigma_t;\n", out);
    }
    fputs("}\n", out);
}

// Writes how a segment that sends `light` forward is added.
static void write_gather_segment(FILE *out, const struct scene_model *model)
{
    fprintf(out,
            "void gather_segment(inout Gathered gathered, Spectrum light, Spectrum optical_depth, float at, float "
            "length)\n{\n    gathered.radiance += %slight;\n",
            model->features.has_throughput ? "gathered.transmittance * " : "");
    if (model->features.has_extinction) {
        fputs("    Spectrum after = gathered.transmittance * segment(optical_depth).transmittance;\n", out);
        if (model->features.has_depth) fputs("    Spectrum sigma_t = optical_depth / length;\n", out);
        write_passed(out, model);
    }
    fputs("}\n", out);
}

// Writes how the light of a point is added, with a weight of transmittance times length, and how the transmittance
// changes behind it.
static void write_tracked(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    bool has_source = features->has_emission || features->media_are_lit;

    fputs("void gather(inout Gathered gathered, MediaField field, vec3 point, vec3 direction, Spectrum weight)\n{\n",
          out);
    if (has_source) {
        scene_glue_write_densities(out, model);
        write_sources(out, model);
        fputs("    gathered.radiance += weight * source;\n", out);
    }
    fprintf(out, "}\nSpectrum gathered_transmittance(Gathered gathered)\n{\n    return %s;\n}\n",
            features->has_throughput ? "gathered.transmittance" : "spectrum(1.0)");
    fputs("void gathered_pass(inout Gathered gathered, Spectrum after, float at)\n{\n", out);
    if (features->has_extinction && features->has_depth)
        fputs("    if (gathered.depth == 0.0 && spectrum_mean(after) <= 0.5) gathered.depth = at;\n", out);
    if (features->has_throughput) write_left(out, model);
    fputs("}\n", out);
}

void scene_glue_write_gather(FILE *out, const struct scene_model *model)
{
    const struct scene_features *features = &model->features;
    const struct scene *scene = &model->job->scene;
    bool has_source =
        features->has_emission || ((features->media_are_lit || features->has_scatter_grid) && !features->places_points);

    write_gathered(out, model);
    if (features->is_tracked) {
        write_tracked(out, model);
        return;
    }
    if (features->is_gauss) {
        write_gather_node(out, model);
        write_gather_segment(out, model);
        return;
    }
    fprintf(out,
            "// `at` is where the segment begins, `point` %s.\n"
            "void gather(inout Gathered gathered, MediaField field, vec3 point, vec3 direction, float at, float "
            "length%s)\n{\n",
            features->marches ? "where the field was evaluated" : "is there",
            features->is_jittered ? ", float offset" : "");
    scene_glue_write_densities(out, model);
    if (has_source) write_sources(out, model);
    if (features->has_extinction) write_sigma_t(out, model);
    if (features->places_points) write_all_placed(out, scene, model);
    if (features->has_extinction)
        write_extinction(out, model, has_source);
    else
        fprintf(out, "    gathered.radiance += %ssource * length;\n",
                features->has_throughput ? "gathered.transmittance * " : "");
    fputs("}\n", out);
}

void scene_glue_write_integrator(FILE *out, const struct scene_model *model, const char *stretch)
{
    fputs("    ", out);
    integrator_write_call(out, &integrator_of(model)->along_rays, model);
    fprintf(out, ", %s, spans, gathered);\n", stretch);
}

// Up to this many points are one Gauss-Legendre rule. More points are several rules of one size, one after the other.
enum { RULE_LIMIT = 64 };

void scene_glue_write_placed(FILE *out, const struct job *job)
{
    int rules = (job->quality.points + RULE_LIMIT - 1) / RULE_LIMIT;
    int size = (job->quality.points + rules - 1) / rules;
    double points[GAUSS_LEGENDRE_LIMIT], weights[GAUSS_LEGENDRE_LIMIT];

    gauss_legendre(size, points, weights);
    for (int i = 0; i < size; ++i) {
        points[i] /= rules;
        weights[i] /= rules;
    }
    scene_glue_write_numbers(out, "PLACED_SHARES", points, size);
    scene_glue_write_numbers(out, "PLACED_WEIGHTS", weights, size);
    fprintf(out, "const int PLACED_COUNT = %d;\n", rules * size);
    fprintf(out, "float placed_share(int i)\n{\n    return PLACED_SHARES[i %% %d] + float(i / %d) * %.9e;\n}\n", size,
            size, 1.0 / rules);
    fprintf(out, "float placed_weight(int i)\n{\n    return PLACED_WEIGHTS[i %% %d];\n}\n", size);
}
