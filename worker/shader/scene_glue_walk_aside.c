// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk_aside.h"

#include "core/job/job.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_walk_lamps.h"
#include "worker/shader/scene_glue_walk_light.h"

#include <math.h>

// Set by what measured best (docs/rendering.md); they change noise and time, not the light.
static const double NARROW = 0.75; // the least g that repays second paths,
static const double BACK = 0.94;   // and that of lobes that send light back, without its sign

double scene_glue_walk_find_lobe(const struct scene_model *model, double sign)
{
    // Of numbers that move as they like, bounds at all times count, so that frames share a program.
    static const struct timeline_span SPAN = {0.0, 0.0};
    double most = 0.0;

    for (size_t i = 0; i < model->features.medium_count; i++)
        for (size_t k = 0; k < model->job->scene.media[i].lobe_count && model->features.media[i].scatters; k++) {
            double min[3], max[3];

            if (model->features.media[i].lobes[k] != LOBE_HENYEY_GREENSTEIN) continue;
            timeline_find_bounds(&model->job->scene.media[i].lobes[k].g, SPAN, min, max);
            most = fmax(most, fmax(sign * min[0], sign * max[0]));
        }
    return most;
}

bool scene_glue_walk_sends(const struct scene_model *model)
{
    bool is_narrow = scene_glue_walk_find_lobe(model, 1.0) >= NARROW || scene_glue_walk_find_lobe(model, -1.0) >= BACK;

    return is_narrow && !model->features.has_objects && scene_glue_walk_knows_lamps(model);
}

// Second paths from lamps within a medium would bring more noise than they take away.
static void write_sends(FILE *out, const struct scene_model *model)
{
    fputs("bool walk_sends()\n{\n    return true", out);
    for (size_t i = 0; i < model->job->scene.light_count; i++)
        if (scene_glue_walk_has_near(model, i)) fprintf(out, " && walk_reach_%zu <= 0.0", i);
    fputs(";\n}\n", out);
}

static void write_goes_on(FILE *out, const struct scene_model *model)
{
    fputs("float walk_aside_goes_on()\n{\n    float g = 0.0;\n", out);
    for (size_t i = 0; i < model->features.medium_count; i++)
        for (size_t k = 0; k < model->job->scene.media[i].lobe_count && model->features.media[i].scatters; k++)
            if (model->features.media[i].lobes[k] == LOBE_HENYEY_GREENSTEIN)
                fprintf(out, "    g = max(g, abs(medium_%zu_lobe_%zu_g));\n", i, k);
    fputs("    return g;\n}\n", out);
}

void scene_glue_write_walk_aside(FILE *out, const struct scene_model *model)
{
    bool goes_on = scene_glue_walk_find_lobe(model, 1.0) >= scene_glue_walk_find_lobe(model, -1.0);

    write_sends(out, model);
    write_goes_on(out, model);
    fprintf(out, "const float WALK_ASIDE_SIDE = %s;\n", goes_on ? "1.0" : "-1.0");
}
