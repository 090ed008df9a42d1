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

static bool is_forward(const struct scene_model *model, size_t medium)
{
    for (size_t i = 0; i < SCENE_LOBE_LIMIT; ++i)
        if (model->features.media[medium].lobes[i] == LOBE_HENYEY_GREENSTEIN) return true;
    return false;
}

// Looking for lamps pays where a lobe is so sharp that its peak is seldom found. docs/rendering.md has the measurement.
static bool is_sharp(const struct scene_model *model, size_t medium)
{
    static const double SHARP = 0.9; // g
    const struct scene_medium *scattering = &model->job->scene.media[medium];

    for (size_t i = 0; i < scattering->lobe_count; ++i) {
        const struct scene_phase_lobe *lobe = &scattering->lobes[i];
        double g[3];

        if (lobe->kind != SCENE_LOBE_HENYEY_GREENSTEIN) continue;
        timeline_evaluate(&lobe->g, 0.0, g);
        if (!timeline_is_constant(&lobe->g) || g[0] >= SHARP) return true;
    }
    return false;
}

static bool aims(const struct scatter_walk_text *text, size_t medium)
{
    return text->lamp_count > 0 && is_sharp(text->model, medium);
}

static void write_turn(const struct scatter_walk_text *text, size_t i)
{
    static const char draw[] = "vec2(walk_random(), walk_random())";

    if (!aims(text, i)) {
        fputs("    turned = ", text->out);
        scatter_similar_glue_write_turn(text->out, text->grid, i, draw);
        fputs(";\n", text->out);
        return;
    }
    if (scatter_grid_is_similar(text->grid))
        fprintf(text->out, "    if (walk_is_similar) turned = medium_%zu_similar_turned(direction, %s);\n    else", i,
                draw);
    fprintf(text->out, "    weight *= medium_%zu_aim(point, direction, %s, turned);\n", i, draw);
}

// Among several media one is drawn by its share of what is scattered.
static void write_scatter(const struct scatter_walk_text *text)
{
    const struct scatter_grid *grid = text->grid;
    const struct scene_model *model = text->model;
    FILE *out = text->out;

    fputs("void walk_scatter(MediaField field, vec3 point, vec3 direction, inout Spectrum weight, out vec3 turned)\n"
          "{\n",
          out);
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
                "    if (draw < spectrum_mean(part_%zu)) {\n    weight = part_%zu * (all / spectrum_mean(part_%zu));\n",
                i, i, i);
        write_turn(text, i);
        fprintf(out, "    return;\n    }\n    draw -= spectrum_mean(part_%zu);\n", i);
    }
    if (grid->medium_count > 1)
        fprintf(out,
                "    float left = spectrum_mean(part_%zu);\n"
                "    weight = left > 0.0 ? part_%zu * (all / left) : spectrum(0.0);\n",
                grid->media[grid->medium_count - 1], grid->media[grid->medium_count - 1]);
    else
        fprintf(out, "    weight = part_%zu;\n", grid->media[0]);
    write_turn(text, grid->media[grid->medium_count - 1]);
    fputs("}\n", out);
}

bool scatter_walk_glue_is_forward(const struct scene_model *model, const struct scatter_grid *grid)
{
    for (size_t k = 0; k < grid->medium_count; ++k)
        if (is_forward(model, grid->media[k])) return true;
    return false;
}

bool scatter_walk_glue_is_sharp(const struct scene_model *model, const struct scatter_grid *grid)
{
    for (size_t k = 0; k < grid->medium_count; ++k)
        if (is_sharp(model, grid->media[k])) return true;
    return false;
}

int scatter_walk_glue_write_lamps(FILE *out, const struct scene_model *model)
{
    int lamps = 0;

    fputs("vec3 walk_lamp(int lamp, vec3 point)\n{\n", out);
    for (size_t i = 0; model->features.media_are_lit && i < model->job->scene.light_count; ++i)
        if (model->features.light_is_marched[i])
            fprintf(out, "    if (lamp == %d) return light_%zu(point).direction;\n", lamps++, i);
    fprintf(out, "    return vec3(0.0, 0.0, 1.0);\n}\nconst int WALK_LAMPS = %d;\n", lamps);
    return lamps;
}

static void write_aim(FILE *out, size_t i)
{
    fprintf(out,
            "float medium_%zu_aim(vec3 point, vec3 direction, vec2 share, out vec3 turned)\n{\n"
            "    float lit = 0.0;\n"
            "    vec3 about = scatter_aim_about(point, direction, share);\n"
            "    turned = medium_%zu_turned(about, share);\n"
            "    for (int i = 0; i < WALK_LAMPS; ++i)\n        lit += medium_%zu_phase(walk_lamp(i, point), turned);\n"
            "    return scatter_aim_weight(medium_%zu_phase(direction, turned), lit);\n}\n",
            i, i, i, i);
}

static void write_first_of(const struct scatter_walk_text *text, size_t leader)
{
    if (aims(text, leader))
        fprintf(text->out, "    return medium_%zu_aim(node, away, share, toward);\n", leader);
    else
        fprintf(text->out, "    toward = medium_%zu_turned(away, share);\n    return 1.0;\n", leader);
}

static void write_first(const struct scatter_walk_text *text)
{
    const struct scatter_grid *grid = text->grid;

    fputs("float walk_first(int set, vec3 node, vec3 away, vec2 share, out vec3 toward)\n{\n", text->out);
    for (size_t group = 0; group + 1 < grid->group_count; ++group) {
        fprintf(text->out, "    if (set == %zu) {\n", group);
        write_first_of(text, grid->leaders[group]);
        fputs("    }\n", text->out);
    }
    write_first_of(text, grid->leaders[grid->group_count - 1]);
    fputs("}\n", text->out);
}

void scatter_walk_glue_write_scatter(const struct scatter_walk_text *text)
{
    const struct scatter_grid *grid = text->grid;

    for (size_t k = 0; k < grid->medium_count; ++k) {
        scatter_similar_glue_write_turned(text->out, text->model, grid->media[k], false);
        if (aims(text, grid->media[k])) write_aim(text->out, grid->media[k]);
    }
    write_scatter(text);
    fprintf(text->out, "Spectrum walk_kept(vec3 rgb)\n{\n    return rgb%s;\n}\n",
            text->model->features.is_rgb ? "" : ".r");
}

void scatter_walk_glue_write(const struct scatter_walk_text *text)
{
    scatter_similar_glue_write(text->out, text->model, text->grid);
    scatter_walk_glue_write_scatter(text);
    // Media that glow without extinction have no collisions.
    fprintf(text->out, "const float WALK_SAMPLES = %s;\n",
            text->model->features.has_emission ? "TRACKING_SAMPLES" : "0.0");
    write_emission(text->out, text->model);
    write_lit(text->out, text->model, text->grid);
    write_sky(text->out, text->model);
    write_first(text);
}
