// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk_aim.h"

#include "core/job/job.h"
#include "core/scene/scene_diameter.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_walk_aside.h"
#include "worker/shader/scene_glue_walk_lamps.h"

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

void scene_glue_write_walk_aim(FILE *out, const struct scene_model *model)
{
    fputs("Spectrum walk_turn(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, int order, "
          "out vec3 outgoing)\n{\n"
          "    Spectrum behind = walk_scatter(vertex, incoming, weight, outgoing);\n",
          out);
    if (scene_glue_walk_has_aims(model)) {
        fputs("    float passed;\n    LightSample light = walk_lamp_seen(walk_lamp_draw(), point, passed);\n"
              "    float share = walk_aim_share(order, passed);\n"
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
