// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk_aim.h"

#include "core/job/job.h"
#include "core/scene/scene_diameter.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_walk_aside.h"

#include <math.h>

// Set by what measured best (docs/rendering.md); they change noise and time, not the light.
static const double NARROW = 0.65; // the least g that repays the looks for lamps
static const double THIN = 6.5;    // the largest optical depth of homogeneous media, along the longest line

// Of numbers that move as they like, bounds at all times count, so that frames share a program.
static const struct timeline_span SPAN = {0.0, 0.0};

static double largest_of(const struct timeline *timeline)
{
    double min[3], max[3], most = -INFINITY;

    timeline_find_bounds(timeline, SPAN, min, max);
    for (int c = 0; c < timeline->component_count; c++)
        most = fmax(most, max[c]);
    return most;
}

static bool is_thin(const struct scene_model *model)
{
    double depth = 0.0;

    for (size_t i = 0; i < model->features.medium_count; i++) {
        const struct scene_medium *medium = &model->job->scene.media[i];

        if (!model->features.media[i].scatters) continue;
        depth += (largest_of(&medium->sigma_s) + largest_of(&medium->sigma_a)) *
                 largest_of(&medium->density.homogeneous.scale) * scene_diameter_of_density(&medium->density, SPAN);
    }
    return depth <= THIN;
}

// Only lamps whose light that reaches a vertex is known there are aimed at.
bool scene_glue_walk_has_aims(const struct scene_model *model)
{
    if (!scene_glue_walk_knows_lamps(model) || scene_glue_walk_find_lobe(model, 1.0) < NARROW) return false;
    return model->features.tracks_to_lights || is_thin(model);
}

// Writes the choice of a lamp, each as likely.
static void write_lamp(FILE *out, const struct scene_model *model)
{
    size_t count = scene_features_count_marched(&model->features), index = 0;

    if (count > 1) fprintf(out, "    int lamp = min(int(walk_random() * %zu.0), %zu);\n", count, count - 1);
    fputs("    LightSample light;\n    float passed = 0.0;\n", out);
    for (size_t i = 0; i < model->job->scene.light_count; i++) {
        if (!model->features.light_is_marched[i]) continue;
        if (count > 1)
            fprintf(out, "    if (lamp == %zu) {\n", index++);
        else
            fputs("    {\n", out);
        fprintf(out,
                "        light = light_%zu(point);\n"
                "        passed = spectrum_mean(walk_reached_%zu(point, 0u, light));\n    }\n",
                i, i);
    }
}

void scene_glue_write_walk_aim(FILE *out, const struct scene_model *model)
{
    fputs("Spectrum walk_turn(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, int order, "
          "out vec3 outgoing)\n{\n"
          "    Spectrum behind = walk_scatter(vertex, incoming, weight, outgoing);\n",
          out);
    if (scene_glue_walk_has_aims(model)) {
        write_lamp(out, model);
        fputs("    float share = walk_aim_share(order, passed);\n"
              "    if (vertex.left != 0u || share < 0.01 || walk_sends()) return behind;\n"
              "    if (walk_random() < share) outgoing = walk_aim_draw(light.direction);\n"
              "    Spectrum scattered = weight * walk_scattered(vertex, incoming, outgoing);\n"
              "    float phase = spectrum_mean(scattered) / max(spectrum_mean(weight * walk_scattering(vertex)), "
              "1e-30);\n"
              "    return scattered / max(mix(phase, walk_aim_density(light.direction, outgoing), share), 1e-30);\n}\n",
              out);
        return;
    }
    fputs("    return behind;\n}\n", out);
}
