// SPDX-License-Identifier: Apache-2.0
#include "worker/model/scatter_grid.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/glsl/timeline_value.h"
#include "worker/model/light_kind.h"
#include "worker/model/scene_model.h"
#include "worker/scene/media_extent.h"
#include "worker/scene/scene_inputs.h"

#include <math.h>
#include <string.h>

// The share of the box's size by which rounding may put a point of the media outside.
static const double margin = 1e-5;

static bool timelines_are_equal(const struct timeline *a, const struct timeline *b)
{
    double value_a[9] = {0}, value_b[9] = {0};

    if (!timeline_is_constant(a) || !timeline_is_constant(b)) return false;
    timeline_evaluate(a, 0, value_a);
    timeline_evaluate(b, 0, value_b);
    return value_a[0] == value_b[0];
}

// True when both media certainly scatter alike at all times.
static bool phases_are_equal(const struct scene_medium *a, const struct scene_medium *b)
{
    if (a->lobe_count != b->lobe_count) return false;
    for (size_t i = 0; i < a->lobe_count; ++i)
        if (a->lobes[i].kind != b->lobes[i].kind || !timelines_are_equal(&a->lobes[i].weight, &b->lobes[i].weight) ||
            (a->lobes[i].kind == SCENE_LOBE_HENYEY_GREENSTEIN && !timelines_are_equal(&a->lobes[i].g, &b->lobes[i].g)))
            return false;
    return true;
}

static void add_medium(struct scatter_grid *grid, size_t medium)
{
    const struct scene_medium *media = grid->job->scene.media;
    size_t group = 0;

    while (group < grid->group_count && !phases_are_equal(&media[medium], &media[grid->leaders[group]]))
        ++group;
    if (group == grid->group_count) grid->leaders[grid->group_count++] = medium;
    grid->groups[medium] = group;
    grid->media[grid->medium_count++] = medium;
}

struct scatter_grid_box scatter_grid_place(const struct scatter_grid *grid, double time)
{
    struct scatter_grid_box box;

    for (int axis = 0; axis < 3; ++axis) {
        double direction[3] = {0}, low = INFINITY, high = -INFINITY, spare;

        for (size_t i = 0; i < grid->medium_count; ++i) {
            struct media_extent extent = media_extent_of(grid->job, grid->inputs, grid->media[i], time);

            direction[axis] = 1;
            high = fmax(high, media_extent_support(&extent, direction));
            direction[axis] = -1;
            low = fmin(low, -media_extent_support(&extent, direction));
        }
        spare = margin * (high - low);
        box.low[axis] = low - spare;
        box.size[axis] = fmax(high - low + 2 * spare, 1e-9);
    }
    return box;
}

static bool is_still(const struct scatter_grid *grid)
{
    bool is_still = true;

    for (size_t i = 0; i < grid->medium_count; ++i)
        is_still &= media_extent_is_still(&grid->job->scene.media[grid->media[i]].density);
    return is_still;
}

// True when the lamp comes into the box at some time.
static bool comes_into(const struct scene_light *light, const struct job *job, const struct scatter_grid_box *box)
{
    double least[3], most[3];

    timeline_find_bounds(&light->position, job_time_span(job), least, most);
    for (int i = 0; i < 3; ++i)
        if (most[i] < box->low[i] || least[i] > box->low[i] + box->size[i]) return false;
    return true;
}

// Walks from the nodes meet no sphere and no sun in an image, and the light of a lamp among them varies without bound.
static bool is_from_lights(const struct scene_model *model, const struct scatter_grid_box *box)
{
    const struct scene *scene = &model->job->scene;
    bool is_from_lights = model->job->quality.scatter_from == JOB_SCATTER_FROM_LIGHTS;

    if (model->job->quality.scatter_from != JOB_SCATTER_FROM_ANY || model->features.has_emission) return is_from_lights;
    for (size_t i = 0; i < scene->light_count; ++i) {
        const struct light_kind *kind = light_kind_of(&scene->lights[i]);

        if (model->features.light_is_seen[i])
            is_from_lights |= kind->is_sphere || kind->has_image ||
                              (kind->is_inverse_square && comes_into(&scene->lights[i], model->job, box));
    }
    return is_from_lights;
}

bool scatter_grid_init(struct scatter_grid *grid, const struct scene_model *model)
{
    const struct job *job = model->job;
    int32_t frame = model->inputs ? model->inputs->frame : frame_range_at(&job->frames, 0);
    struct scatter_grid_box box;
    double longest;

    *grid = (struct scatter_grid){.job = job, .inputs = model->inputs};
    for (size_t i = 0; i < model->features.medium_count; ++i)
        if (model->features.media[i].scatters) add_medium(grid, i);
    grid->is_rgb = model->features.is_rgb;
    grid->is_still = is_still(grid);
    box = scatter_grid_place(grid, job_frame_time(job, frame));
    grid->is_from_lights = is_from_lights(model, &box);
    longest = fmax(fmax(box.size[0], box.size[1]), box.size[2]);
    if (!isfinite(longest)) return false;
    for (int i = 0; i < 3; ++i) {
        double cells = ceil(job->quality.scatter_grid * box.size[i] / longest - 1e-6);

        grid->nodes[i] = 1 + (int)fmax(cells, 1);
        grid->cell_m = fmax(grid->cell_m, box.size[i] / fmax(cells, 1));
    }
    return true;
}

static void evaluate_low(const void *source, double time, double value[static 9])
{
    const struct scatter_grid_box box = scatter_grid_place(source, time);

    memcpy(value, box.low, sizeof box.low);
}

static void evaluate_size(const void *source, double time, double value[static 9])
{
    const struct scatter_grid_box box = scatter_grid_place(source, time);

    memcpy(value, box.size, sizeof box.size);
}

void scatter_grid_add_values(struct frame_uniforms *uniforms, const struct scatter_grid *grid)
{
    struct frame_value value = {.type = FRAME_VALUE_VEC3,
                                .is_constant = grid->is_still,
                                .evaluate = evaluate_low,
                                .is_position = true,
                                .source = grid,
                                .min = value_range_any.min,
                                .max = value_range_any.max,
                                .meaning = "positions of the media"};

    frame_uniforms_add(uniforms, value, "scatter_grid_low");
    value.evaluate = evaluate_size;
    value.is_position = false;
    frame_uniforms_add(uniforms, value, "scatter_grid_size");
}

static void evaluate_paths(const void *source, double time, double value[static 9])
{
    const struct scatter_grid *grid = source;

    (void)time;
    value[0] = grid->job->quality.paths;
}

void scatter_grid_add_paths(struct frame_uniforms *uniforms, const struct scatter_grid *grid)
{
    const struct frame_value value = {.type = FRAME_VALUE_FLOAT,
                                      .origin = FRAME_VALUE_OF_PLAN,
                                      .evaluate = evaluate_paths,
                                      .source = grid,
                                      .min = value_range_not_negative.min,
                                      .max = value_range_not_negative.max,
                                      .meaning = "quality.paths"};

    frame_uniforms_add(uniforms, value, "scatter_grid_paths");
}

bool scatter_grid_is_similar(const struct scatter_grid *grid)
{
    return grid->job->quality.similar_after > 0 && !grid->is_from_lights;
}

size_t scatter_grid_node_count(const struct scatter_grid *grid)
{
    return (size_t)grid->nodes[0] * (size_t)grid->nodes[1] * (size_t)grid->nodes[2];
}

int scatter_grid_lane_count(const struct scatter_grid *grid)
{
    static const size_t nodes_most = (size_t)1 << 19; // 64 MiB of texels of eight lanes

    return scatter_grid_node_count(grid) * grid->group_count <= nodes_most ? 8 : 1;
}

int scatter_grid_light_cells(const struct scatter_grid *grid)
{
    static const int sizes[] = {48, 64, 96, 128, 192};
    static const double slack = 1.1;                                                   // by which cells may be longer
    size_t light_count = grid->job->scene.light_count, most = (size_t)192 * 192 * 192; // of all lights' cells
    double step_m = grid->inputs ? grid->inputs->quality.light_step : grid->job->quality.light_step;
    double longest_m = grid->cell_m * grid->job->quality.scatter_grid;
    size_t i = 0;

    if (!(step_m > 0)) return sizes[0];
    while (i + 1 < sizeof sizes / sizeof *sizes && sizes[i] * step_m * slack < longest_m &&
           light_count * (size_t)(sizes[i + 1] * sizes[i + 1] * sizes[i + 1]) <= most)
        i++;
    return sizes[i];
}

bool scatter_grid_check_size(const struct scatter_grid *grid, struct error *error)
{
    static const double limit = 512.0 * 1024 * 1024, texel = 16, sum = 8; // bytes
    double seen = 4, lanes = scatter_grid_lane_count(grid);
    double fill = grid->is_from_lights ? sum * (grid->is_rgb ? 3 : 1) : seen + texel * lanes;
    double size = (texel + fill) * (double)grid->group_count * (double)scatter_grid_node_count(grid);

    if (size <= limit) return true;
    error_set(error,
              "quality.scatter_grid: expected at most about %.0f cells here, since a frame's grid takes up to 512 MiB; "
              "%d need %.0f",
              floor(grid->job->quality.scatter_grid * cbrt(limit / size)) - 1, grid->job->quality.scatter_grid,
              size / (1024 * 1024));
    return false;
}

int scatter_grid_row_count(const struct scatter_grid *grid)
{
    static const double particles = 64, most = 1024; // of an invocation at least; rows
    double all = (double)scatter_grid_node_count(grid) * grid->job->quality.paths;

    return (int)fmin(fmax(ceil(all / (particles * SCATTER_GRID_ROW)), 1), most);
}

static void evaluate_nodes(const void *source, double time, double value[static 9])
{
    const struct scatter_grid *grid = source;

    (void)time;
    for (int i = 0; i < 3; ++i)
        value[i] = grid->nodes[i];
}

// Floats hold whole numbers up to 2^24 exactly.
static void evaluate_sent(const void *source, double time, double value[static 9])
{
    const struct scatter_grid *grid = source;
    double all = (double)scatter_grid_node_count(grid) * grid->job->quality.paths;

    (void)time;
    value[0] = fmin(ceil(all / (SCATTER_GRID_ROW * scatter_grid_row_count(grid))), 1 << 24);
}

void scatter_grid_add_sent(struct frame_uniforms *uniforms, const struct scatter_grid *grid)
{
    struct frame_value value = {.type = FRAME_VALUE_FLOAT,
                                .origin = FRAME_VALUE_OF_PLAN,
                                .evaluate = evaluate_sent,
                                .source = grid,
                                .min = value_range_not_negative.min,
                                .max = value_range_not_negative.max,
                                .meaning = "quality.paths"};

    frame_uniforms_add(uniforms, value, "scatter_grid_sent");
    value.type = FRAME_VALUE_VEC3;
    value.evaluate = evaluate_nodes;
    value.meaning = "quality.scatter_grid";
    frame_uniforms_add(uniforms, value, "scatter_grid_nodes");
}
