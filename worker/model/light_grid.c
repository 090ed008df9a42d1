// SPDX-License-Identifier: Apache-2.0
#include "worker/model/light_grid.h"

#include "core/job/job.h"
#include "core/scene/light_rules.h"
#include "worker/glsl/timeline_value.h"
#include "worker/model/scene_model.h"
#include "worker/scene/media_extent.h"
#include "worker/scene/pixel_samples.h"
#include "worker/scene/scene_inputs.h"

#include <math.h>
#include <string.h>

// The limit of a beam's tangent: its cells grow with the tangent's square towards the edges, until a round grid does
// better.
static const double tangent_limit = 1.75;
// The share of the grid's size by which rounding may put a point of the media outside.
static const double margin = 1e-5;

struct frame {
    double across[3], up[3], along[3]; // unit vectors; `along` is the direction of travel of light
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalize(double v[3])
{
    double length = sqrt(dot(v, v));

    for (int i = 0; i < 3; ++i)
        v[i] /= length;
}

static void negate(const double v[3], double negative[3])
{
    for (int i = 0; i < 3; ++i)
        negative[i] = -v[i];
}

static void cross(const double a[3], const double b[3], double product[3])
{
    for (int i = 0; i < 3; ++i)
        product[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

// Completes the frame with any two directions perpendicular to `along`.
static void complete(struct frame *frame)
{
    int least = 0;
    double axis[3] = {0};

    for (int i = 1; i < 3; ++i)
        if (fabs(frame->along[i]) < fabs(frame->along[least])) least = i;
    axis[least] = 1;
    cross(frame->along, axis, frame->across);
    normalize(frame->across);
    cross(frame->along, frame->across, frame->up);
}

static const struct scene_light *light_of(const struct light_grid *grid)
{
    return &grid->job->scene.lights[grid->light];
}

static size_t find_extents(const struct light_grid *grid, double time,
                           struct media_extent extents[JOB_CACHED_MEDIUM_LIMIT])
{
    for (size_t i = 0; i < grid->medium_count; ++i)
        extents[i] = media_extent_of(grid->job, grid->inputs, grid->media[i], time);
    return grid->medium_count;
}

// Returns the largest dot(p, direction) over all media.
static double support_of(const struct media_extent *extents, size_t count, const double direction[3])
{
    double support = -INFINITY;

    for (size_t i = 0; i < count; ++i)
        support = fmax(support, media_extent_support(&extents[i], direction));
    return support;
}

static double tangent_of(const struct media_extent *extents, size_t count, const double from[3], const double across[3],
                         const double along[3])
{
    double tangent = -INFINITY;

    for (size_t i = 0; i < count; ++i)
        tangent = fmax(tangent, media_extent_tangent(&extents[i], from, across, along));
    return tangent;
}

// Finds the middle of the box along the world's axes around all media.
static void find_middle(const struct media_extent *extents, size_t count, double middle[3])
{
    for (int i = 0; i < 3; ++i) {
        double axis[3] = {0};

        axis[i] = 1;
        middle[i] = support_of(extents, count, axis);
        axis[i] = -1;
        middle[i] = 0.5 * (middle[i] - support_of(extents, count, axis));
    }
}

// How far the media extend from the middle along and across the light, m, measured in the plane of the middle.
struct beam {
    struct frame frame;
    double middle[3];
    double low[3], high[3]; // across, up, along
    double distance;        // from the light to the plane of the middle; INFINITY for parallel light
};

static void find_parallel_beam(const struct media_extent *extents, size_t count, const struct scene_light *light,
                               double time, struct beam *beam)
{
    const double *const axes[] = {beam->frame.across, beam->frame.up, beam->frame.along};
    double direction[9] = {0};

    timeline_value_evaluate_unit(&light->direction, time, direction);
    memcpy(beam->frame.along, direction, sizeof beam->frame.along);
    complete(&beam->frame);
    beam->distance = INFINITY;
    for (int i = 0; i < 3; ++i) {
        double back[3], at = dot(beam->middle, axes[i]);

        negate(axes[i], back);
        beam->high[i] = support_of(extents, count, axes[i]) - at;
        beam->low[i] = -support_of(extents, count, back) - at;
    }
}

// Returns false where the light is among the media, or sees them under too wide an angle.
static bool find_point_beam(const struct media_extent *extents, size_t count, const struct scene_light *light,
                            double time, struct beam *beam)
{
    const double *const axes[] = {beam->frame.across, beam->frame.up, beam->frame.along};
    double position[9] = {0}, back[3];

    timeline_evaluate(&light->position, time, position);
    for (int i = 0; i < 3; ++i)
        beam->frame.along[i] = beam->middle[i] - position[i];
    beam->distance = sqrt(dot(beam->frame.along, beam->frame.along));
    if (!(beam->distance > 0)) return false;
    normalize(beam->frame.along);
    complete(&beam->frame);
    for (int i = 0; i < 2; ++i) {
        negate(axes[i], back);
        beam->high[i] = tangent_of(extents, count, position, axes[i], beam->frame.along);
        beam->low[i] = -tangent_of(extents, count, position, back, beam->frame.along);
        if (!(fmax(beam->high[i], -beam->low[i]) <= tangent_limit)) return false;
        beam->high[i] *= beam->distance;
        beam->low[i] *= beam->distance;
    }
    negate(axes[2], back);
    beam->high[2] = support_of(extents, count, axes[2]) - dot(beam->middle, axes[2]);
    beam->low[2] = -support_of(extents, count, back) - dot(beam->middle, axes[2]);
    return beam->low[2] > -beam->distance * (1 - 1e-3);
}

static bool find_beam(const struct light_grid *grid, double time, struct beam *beam)
{
    const struct scene_light *light = light_of(grid);
    struct media_extent extents[JOB_CACHED_MEDIUM_LIMIT];
    size_t count = find_extents(grid, time, extents);

    find_middle(extents, count, beam->middle);
    if (light_rules_of(light->kind)->has_position) return find_point_beam(extents, count, light, time, beam);
    find_parallel_beam(extents, count, light, time, beam);
    return true;
}

static void place_beam(const struct beam *beam, struct light_grid_placement *placement)
{
    const double *const axes[] = {beam->frame.across, beam->frame.up, beam->frame.along};
    double size[3];

    memcpy(placement->center, beam->middle, sizeof placement->center);
    for (int i = 0; i < 3; ++i) {
        size[i] = fmax((beam->high[i] - beam->low[i]) * (1 + 2 * margin), 1e-9);
        placement->origin[i] = 0.5 - 0.5 * (beam->high[i] + beam->low[i]) / size[i];
        for (int k = 0; k < 3; ++k) {
            placement->from_unit[3 * i + k] = axes[i][k] * size[i];
            placement->to_unit[3 * k + i] = axes[i][k] / size[i];
        }
    }
    placement->taper = size[2] / beam->distance;
}

static void place_round(const struct light_grid *grid, double time, struct light_grid_placement *placement)
{
    struct media_extent extents[JOB_CACHED_MEDIUM_LIMIT];
    size_t count = find_extents(grid, time, extents);
    double position[9] = {0};

    timeline_evaluate(&light_of(grid)->position, time, position);
    placement->near = INFINITY;
    placement->far = 0;
    for (size_t i = 0; i < count; ++i) {
        double near, far;

        media_extent_distances(&extents[i], position, &near, &far);
        placement->near = fmin(placement->near, near);
        placement->far = fmax(placement->far, far);
    }
    placement->near *= 1 - margin;
    placement->far = fmax(placement->far * (1 + margin), placement->near + 1e-9);
}

void light_grid_place(const struct light_grid *grid, double time, struct light_grid_placement *placement)
{
    struct beam beam = {0};

    *placement = (struct light_grid_placement){0};
    if (grid->kind == LIGHT_GRID_ROUND) {
        place_round(grid, time, placement);
        return;
    }
    (void)find_beam(grid, time, &beam); // the kind was chosen for it
    place_beam(&beam, placement);
}

static bool beam_does(const struct light_grid *grid, double time)
{
    struct beam beam = {0};

    return find_beam(grid, time, &beam);
}

// True when nothing that the grid's position follows from moves. Contents of files may change with the frame.
static bool is_still(const struct light_grid *grid)
{
    const struct scene_light *light = light_of(grid);
    bool is_still = timeline_is_constant(&light->position) && timeline_is_constant(&light->direction);

    for (size_t i = 0; i < grid->medium_count; ++i)
        is_still &= media_extent_is_still(&grid->job->scene.media[grid->media[i]].density);
    return is_still;
}

void light_grid_init(struct light_grid *grid, const struct scene_model *model, size_t light)
{
    const struct scene_features *features = &model->features;
    const struct job *job = model->job;
    int32_t frame = model->inputs ? model->inputs->frame : frame_range_at(&job->frames, 0);

    *grid = (struct light_grid){.job = job, .inputs = model->inputs, .light = light, .cells = job->quality.light_grid};
    for (size_t i = 0; i < features->medium_count && grid->medium_count < JOB_CACHED_MEDIUM_LIMIT; ++i)
        if (medium_features_march_to_lights(&features->media[i])) grid->media[grid->medium_count++] = i;
    grid->is_still = is_still(grid);
    for (int i = 0; i < pixel_samples_count(job); ++i)
        if (!beam_does(grid, pixel_samples_time(job, frame, i))) grid->kind = LIGHT_GRID_ROUND;
}

// Evaluates components of the placement, by their offset in it.
static void evaluate(const void *source, double time, size_t offset_bytes, int count, double value[static 9])
{
    struct light_grid_placement placement;

    light_grid_place(source, time, &placement);
    memcpy(value, (const char *)&placement + offset_bytes, (size_t)count * sizeof *value);
}

#define EVALUATE(name, member, count)                                                                                  \
    static void evaluate_##name(const void *source, double time, double value[static 9])                               \
    {                                                                                                                  \
        evaluate(source, time, offsetof(struct light_grid_placement, member), (count), value);                         \
    }

EVALUATE(center, center, 3)
EVALUATE(from_unit, from_unit, 9)
EVALUATE(to_unit, to_unit, 9)
EVALUATE(origin, origin, 3)
EVALUATE(taper, taper, 1)
EVALUATE(near, near, 1)
EVALUATE(far, far, 1)

void light_grid_add_values(struct frame_uniforms *uniforms, const struct light_grid *grid, size_t index)
{
    static const struct {
        const char *name;
        enum light_grid_kind kind;
        enum frame_value_type type;
        frame_value_evaluate *evaluate;
    } values[] = {{"center", LIGHT_GRID_BEAM, FRAME_VALUE_VEC3, evaluate_center},
                  {"from_unit", LIGHT_GRID_BEAM, FRAME_VALUE_MAT3, evaluate_from_unit},
                  {"to_unit", LIGHT_GRID_BEAM, FRAME_VALUE_MAT3, evaluate_to_unit},
                  {"origin", LIGHT_GRID_BEAM, FRAME_VALUE_VEC3, evaluate_origin},
                  {"taper", LIGHT_GRID_BEAM, FRAME_VALUE_FLOAT, evaluate_taper},
                  {"near", LIGHT_GRID_ROUND, FRAME_VALUE_FLOAT, evaluate_near},
                  {"far", LIGHT_GRID_ROUND, FRAME_VALUE_FLOAT, evaluate_far}};

    for (size_t i = 0; i < sizeof values / sizeof *values; ++i)
        if (values[i].kind == grid->kind)
            frame_uniforms_add(uniforms,
                               (struct frame_value){.type = values[i].type,
                                                    .is_constant = grid->is_still,
                                                    .evaluate = values[i].evaluate,
                                                    .is_position = values[i].evaluate == evaluate_center,
                                                    .source = grid,
                                                    .min = value_range_any.min,
                                                    .max = value_range_any.max,
                                                    .meaning = "positions of the light and of the media"},
                               "light_%zu_grid_%s", index, values[i].name);
}
