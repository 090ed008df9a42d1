// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scatter_walk_glue.h"

#include "core/job/job.h"
#include "worker/model/light_kind.h"
#include "worker/model/scatter_grid.h"
#include "worker/model/scene_model.h"
#include "worker/shader/scatter_similar_glue.h"
#include "worker/shader/scene_glue_gather.h"

static void write_emission(FILE *out, const struct scene_model *model)
{
    fputs("Spectrum walk_emission(MediaField field, vec3 point)\n{\n    Spectrum source = spectrum(0.0);\n", out);
    if (model->features.has_emission) {
        scene_glue_write_densities(out, model);
        scene_glue_write_emitted(out, model);
    }
    fputs("    return source;\n}\n", out);
}

static void write_passed(FILE *out, const struct scene_model *model, const struct scatter_grid *grid, size_t light)
{
    const char *transmittance = scatter_grid_is_similar(grid) ? "walk_transmittance" : "media_transmittance";

    if (model->features.has_light_grids)
        fprintf(out, "%s(light_%zu_column(point, light))", transmittance, light);
    else if (!model->features.marches_to_lights)
        fprintf(out, "%s(transmittance_closed(media_spans(point, light.direction), light.distance))", transmittance);
    else
        fputs("media_transmittance_estimate(media_spans(point, light.direction), point, light.direction, "
              "vec2(0.0, light.distance), 0.0)",
              out);
}

static void write_scattered(FILE *out, const struct scene_model *model, const struct scatter_grid *grid)
{
    const char *separator = "";

    fputs("        Spectrum scattered = ", out);
    for (size_t k = 0; k < grid->medium_count; ++k) {
        fprintf(out, "%smedium_%zu_sigma_s * (density_%zu * ", separator, grid->media[k], grid->media[k]);
        scatter_similar_glue_write_phase(out, grid, grid->media[k]);
        fputs(")", out);
        separator = " + ";
    }
    fputs(";\n", out);
}

static void write_lit(FILE *out, const struct scene_model *model, const struct scatter_grid *grid)
{
    fputs("Spectrum walk_lit(MediaField field, vec3 point, vec3 direction)\n{\n    Spectrum source = spectrum(0.0);\n",
          out);
    if (model->features.media_are_lit) scene_glue_write_densities(out, model);
    for (size_t i = 0; model->features.media_are_lit && i < model->job->scene.light_count; ++i) {
        if (!model->features.light_is_marched[i]) continue;
        fprintf(out, "    {\n        LightSample light = light_%zu(point);\n", i);
        write_scattered(out, model, grid);
        fputs("        source += scattered * light.irradiance * ", out);
        write_passed(out, model, grid, i);
        fputs(";\n    }\n", out);
    }
    fputs("    return source;\n}\n", out);
}

// Writes the light of domes, which walks see where they leave the media.
static void write_sky(FILE *out, const struct scene_model *model)
{
    const struct scene *scene = &model->job->scene;

    bool has_dome = false;

    fputs("Spectrum walk_sky(vec3 toward)\n{\n    Spectrum light = spectrum(0.0);\n", out);
    for (size_t i = 0; i < scene->light_count; ++i)
        if (model->features.light_is_seen[i] && light_kind_of(&scene->lights[i])->is_dome) {
            fprintf(out, "    light += light_%zu_radiance(toward);\n", i);
            has_dome = true;
        }
    fprintf(out, "    return light;\n}\nconst bool WALK_HAS_SKY = %s;\n", has_dome ? "true" : "false");
}

// Among several media one is drawn by its share of what is scattered.
static void write_scatter(FILE *out, const struct scene_model *model, const struct scatter_grid *grid)
{
    fputs("void walk_scatter(MediaField field, vec3 direction, inout Spectrum weight, out vec3 turned)\n{\n", out);
    scene_glue_write_densities(out, model);
    if (grid->medium_count > 1) fputs("    float all = 0.0;\n", out);
    for (size_t k = 0; k < grid->medium_count; ++k) {
        size_t i = grid->media[k];

        fprintf(out, "    Spectrum part_%zu = weight * medium_%zu_sigma_s * density_%zu", i, i, i);
        scatter_similar_glue_write_share(out, grid, i);
        fputs(";\n", out);
        if (grid->medium_count > 1) fprintf(out, "    all += spectrum_mean(part_%zu);\n", i);
    }
    if (grid->medium_count > 1) fputs("    float draw = walk_random() * all;\n", out);
    for (size_t k = 0; k + 1 < grid->medium_count; ++k) {
        size_t i = grid->media[k];

        fprintf(out,
                "    if (draw < spectrum_mean(part_%zu)) {\n        weight = part_%zu * (all / "
                "spectrum_mean(part_%zu));\n        turned = ",
                i, i, i);
        scatter_similar_glue_write_turn(out, grid, i, "vec2(walk_random(), walk_random())");
        fprintf(out, ";\n        return;\n    }\n    draw -= spectrum_mean(part_%zu);\n", i);
    }
    if (grid->medium_count > 1)
        fprintf(out,
                "    float left = spectrum_mean(part_%zu);\n"
                "    weight = left > 0.0 ? part_%zu * (all / left) : spectrum(0.0);\n",
                grid->media[grid->medium_count - 1], grid->media[grid->medium_count - 1]);
    else
        fprintf(out, "    weight = part_%zu;\n", grid->media[0]);
    fputs("    turned = ", out);
    scatter_similar_glue_write_turn(out, grid, grid->media[grid->medium_count - 1],
                                    "vec2(walk_random(), walk_random())");
    fputs(";\n}\n", out);
}

static void write_first(FILE *out, const struct scatter_grid *grid)
{
    fputs("vec3 walk_first(int set, vec3 direction, vec2 draw)\n{\n", out);
    for (size_t group = 0; group + 1 < grid->group_count; ++group)
        fprintf(out, "    if (set == %zu) return medium_%zu_turned(direction, draw);\n", group, grid->leaders[group]);
    fprintf(out, "    return medium_%zu_turned(direction, draw);\n}\n", grid->leaders[grid->group_count - 1]);
}

void scatter_walk_glue_write_scatter(FILE *out, const struct scene_model *model, const struct scatter_grid *grid)
{
    for (size_t k = 0; k < grid->medium_count; ++k)
        scatter_similar_glue_write_turned(out, model, grid->media[k], false);
    write_scatter(out, model, grid);
    fprintf(out, "Spectrum walk_kept(vec3 rgb)\n{\n    return rgb%s;\n}\n", model->features.is_rgb ? "" : ".r");
}

void scatter_walk_glue_write(FILE *out, const struct scene_model *model, const struct scatter_grid *grid)
{
    scatter_similar_glue_write(out, model, grid);
    scatter_walk_glue_write_scatter(out, model, grid);
    // Media that glow without extinction have no collisions.
    fprintf(out, "const float WALK_SAMPLES = %s;\n", model->features.has_emission ? "TRACKING_SAMPLES" : "0.0");
    write_emission(out, model);
    write_lit(out, model, grid);
    write_sky(out, model);
    write_first(out, grid);
}
