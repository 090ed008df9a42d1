// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk.h"

#include "core/job/job.h"
#include "worker/model/scene_model.h"
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
    write_scatter(out, model);
}

void scene_glue_write_walk_start(FILE *out)
{
    fputs("WalkRay walk_camera;\nuvec2 walk_pixel;\n"
          "WalkRay walk_start(int path)\n{\n"
          "    walk_random_start(walk_pixel, uint(path), uint(sample_index), uint(frame_seed));\n"
          "    return walk_camera;\n}\n",
          out);
}
