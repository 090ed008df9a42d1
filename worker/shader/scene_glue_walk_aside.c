// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scene_glue_walk_aside.h"

#include "core/job/job.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scene_glue_walk_light.h"

#include <math.h>

// Set by what measured best (docs/rendering.md); they change noise and time, not the light.
static const double NARROW = 0.75; // the least g that repays second paths,
static const double BACK = 0.94;   // and that of lobes that send light back, without its sign

bool scene_glue_walk_knows_lamps(const struct scene_model *model)
{
    const struct scene_features *features = &model->features;

    if (model->job->scene.orders == 1 || !features->media_are_lit) return false;
    return scene_features_count_marched(features) > 0 && (!features->tracks_to_lights || features->has_light_grids);
}

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

// Writes whether second paths are sent: from lamps within a medium they would bring more noise than they take away.
static void write_sends(FILE *out, const struct scene_model *model)
{
    bool sends = scene_glue_walk_sends(model);

    fprintf(out, "const bool WALK_SENDS = %s;\nbool walk_sends()\n{\n    return WALK_SENDS", sends ? "true" : "false");
    for (size_t i = 0; sends && i < model->job->scene.light_count; i++)
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

// Writes a lamp as the vertex sees it, with the chance of a second path.
static void write_lamp_aside(FILE *out, size_t i)
{
    fprintf(out,
            "        LightSample light = light_%zu(point);\n"
            "        float chance = !walk_sends() ? 0.0 : walk_aside_chance(spectrum_mean(walk_reached_%zu(point, 0u, "
            "light)),\n"
            "            walk_aside_phase(incoming, light.direction * walk_aside_side(), vertex, weight), "
            "walk_aside_goes_on());\n",
            i, i);
}

// Whether lobes send light on, or back.
static void write_side(FILE *out, const struct scene_model *model)
{
    fprintf(out, "float walk_aside_side()\n{\n    return %s;\n}\n",
            scene_glue_walk_find_lobe(model, 1.0) >= scene_glue_walk_find_lobe(model, -1.0) ? "1.0" : "-1.0");
}

static void write_aside_density(FILE *out, const struct scene_model *model)
{
    fputs("float walk_aside_density(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, vec3 outgoing)\n{\n"
          "    float sum = 0.0;\n",
          out);
    for (size_t i = 0; i < model->job->scene.light_count; i++) {
        if (!model->features.light_is_marched[i]) continue;
        fputs("    {\n", out);
        write_lamp_aside(out, i);
        fputs("        if (chance > 0.0) sum += chance * walk_aside_phase(light.direction, outgoing, vertex, weight);\n"
              "    }\n",
              out);
    }
    fprintf(out, "    return sum / (%zu.0 * max(walk_aside_phase(incoming, outgoing, vertex, weight), 1e-30));\n}\n",
            scene_features_count_marched(&model->features));
}

static void write_aside_draw(FILE *out, const struct scene_model *model)
{
    size_t count = scene_features_count_marched(&model->features), index = 0;

    fputs("Spectrum walk_aside(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, out vec3 outgoing)\n{\n"
          "    float sent = 0.0;\n    vec3 toward = incoming;\n",
          out);
    if (count > 1) fprintf(out, "    int lamp = min(int(walk_random() * %zu.0), %zu);\n", count, count - 1);
    for (size_t i = 0; i < model->job->scene.light_count; i++) {
        if (!model->features.light_is_marched[i]) continue;
        if (count > 1)
            fprintf(out, "    if (lamp == %zu) {\n", index++);
        else
            fputs("    {\n", out);
        write_lamp_aside(out, i);
        fputs("        sent = chance;\n        toward = light.direction;\n    }\n", out);
    }
    fputs("    outgoing = toward;\n    if (sent <= 0.0 || walk_random() >= sent) return spectrum(0.0);\n"
          "    walk_scatter(vertex, toward, weight, outgoing);\n"
          "    return weight * walk_scattered(vertex, incoming, outgoing) /\n"
          "           max(walk_aside_phase(incoming, outgoing, vertex, weight), 1e-30);\n}\n",
          out);
}

void scene_glue_write_walk_aside(FILE *out, const struct scene_model *model)
{
    write_sends(out, model);
    if (!scene_glue_walk_sends(model)) {
        fputs("float walk_aside_goes_on()\n{\n    return 0.0;\n}\n"
              "float walk_aside_density(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, vec3 outgoing)\n"
              "{\n    return 0.0;\n}\n"
              "Spectrum walk_aside(vec3 point, vec3 incoming, WalkVertex vertex, Spectrum weight, out vec3 outgoing)\n"
              "{\n    outgoing = incoming;\n    return spectrum(0.0);\n}\n",
              out);
        return;
    }
    fputs("float walk_aside_phase(vec3 incoming, vec3 outgoing, WalkVertex vertex, Spectrum weight)\n{\n"
          "    return spectrum_mean(weight * walk_scattered(vertex, incoming, outgoing)) /\n"
          "           max(spectrum_mean(weight * walk_scattering(vertex)), 1e-30);\n}\n",
          out);
    write_goes_on(out, model);
    write_side(out, model);
    write_aside_density(out, model);
    write_aside_draw(out, model);
}
