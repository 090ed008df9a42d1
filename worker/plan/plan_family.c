// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_family.h"

#include "core/job/job_layers.h"
#include "core/job/scattering_check.h"
#include "core/job/step_check.h"
#include "core/json/json_read.h"
#include "worker/audit/truth_lengths.h"
#include "worker/density/density_bake.h"
#include "worker/model/scene_features.h"
#include "worker/plan/plan_similar.h"
#include "worker/plan/scatter_search.h"

#include <math.h>
#include <string.h>

enum {
    FIRST_STEPS = 16,
    STEP_RUNGS = 25,
    DEPTH_RUNGS = 20,
    PATH_RUNGS = 8,
    TRANSMITTANCE_RUNGS = 9, // the last is 0: no ray ends early
    BAKED_OCTAVES = 3,
    SMALL_LEVEL_LIMIT = 6,
    SEEN_RUNG = 10,       // 512 steps,
    SEEN_VOXELS_RUNG = 8, // or two a voxel
    UNBAKED_RUNG = 9      // above 128 cells, where filling takes longer than it saves: the density itself is evaluated
};

// The coarsest rungs, set by hand: tests/worker/plan/tolerance_random_test and bench/predictions start from them.
static const double VOXELS_FIRST = 8.0;       // a step
static const double VOXELS_OF_A_PATH = 128.0; // the assumed length of a path
static const double DEPTH_FIRST = 4.0;        // optical depth of a step
static const double TRANSMITTANCE_FIRST = 0.02;
static const double FLIGHTS = 16.0;    // of a random path, where they are not counted
static const double LIGHT_SHARE = 0.5; // of the longest path: a path towards a light, where it is not measured

static const int points[] = {1, 2, 3, 4, 6, 8, 11, 16, 22, 32, 45, 64, 90, 128, 180, 256, 362, 512, 724, 1000};
static const int grids[] = {8, 11, 16, 22, 32, 45, 64, 90, 128, 181, 256};

#define COUNT(array) ((int)(sizeof(array) / sizeof *(array)))

static bool serves_even(const struct plan_scene *scene)
{
    return scene->is_even || !scene->has_media;
}

static bool serves_marched(const struct plan_scene *scene)
{
    return !serves_even(scene);
}

static bool serves_scattered(const struct plan_scene *scene)
{
    return scene->is_scattered;
}

static bool serves_lit(const struct plan_scene *scene)
{
    return serves_marched(scene) && scene->has_lights;
}

// Paths that take light from grids, where step_check lets them.
static bool serves_path_grids(const struct plan_scene *scene)
{
    return serves_scattered(scene) && serves_lit(scene);
}

// True for noise of several octaves that density_bake can put into a grid.
static bool serves_baked(const struct plan_scene *scene)
{
    struct job baked = *scene->job;
    bool is_baked = false;

    baked.quality.method = JOB_METHOD_CACHED;
    baked.quality.density_grid = 128;
    for (size_t i = 0; i < baked.scene.medium_count; i++) {
        const struct scene_density *density = &baked.scene.media[i].density;
        struct density_bake bake;

        is_baked |= density->kind == SCENE_DENSITY_NOISE && density->noise.octaves >= BAKED_OCTAVES &&
                    density_bake_find(&bake, &baked, i);
    }
    return serves_lit(scene) && is_baked;
}

static bool serves_transfer(const struct plan_scene *scene)
{
    bool has_transfer = false;

    for (size_t i = 0; i < scene->job->scene.medium_count; i++)
        has_transfer |= scene->job->scene.media[i].density.kind == SCENE_DENSITY_GRID &&
                        scene->job->scene.media[i].density.grid.point_count > 0;
    return serves_marched(scene) && has_transfer;
}

// The first steps are at most a quarter of the smallest medium whose density varies: two renders in steps that are
// longer than it agree, whatever is in it.
static int find_small_level(const struct plan_scene *scene)
{
    double first = scene->path_length / FIRST_STEPS, small = 0.25 * step_smallest_diameter(scene->job);
    double level = ceil(log2(first / small));

    if (scene->counts_voxels || !(level > 0.0)) return 0;
    return (int)fmin(level, SMALL_LEVEL_LIMIT);
}

void plan_scene_init(struct plan_scene *scene, const struct job *job)
{
    struct job marched = *job;
    struct scene_features features;

    marched.quality.method = JOB_METHOD_MIDPOINT;
    features = scene_features_of(&marched, NULL);
    *scene = (struct plan_scene){.job = job,
                                 .is_even = true,
                                 .has_media = features.has_media,
                                 .has_lights = features.has_lights && features.media_are_lit,
                                 .has_extinction = features.has_extinction,
                                 .has_paths = features.has_paths,
                                 .has_roughness = features.has_roughness,
                                 .is_scattered = job->scene.orders != 1,
                                 .path_flights = FLIGHTS,
                                 .pixels = (double)job->width_px * job->height_px};
    for (size_t i = 0; i < job->scene.medium_count; i++) {
        const struct scene_density *density = &job->scene.media[i].density;

        scene->is_even &= scene_density_is_even(density);
        scene->counts_voxels |= density->kind == SCENE_DENSITY_GRID;
    }
    scene->path_length = scene->counts_voxels ? VOXELS_OF_A_PATH : step_longest_path(job);
    scene->camera_length = scene->path_length;
    scene->light_length = LIGHT_SHARE * scene->path_length;
    scene->small_level = find_small_level(scene);
}

void plan_scene_measure_lengths(struct plan_scene *scene, const int32_t *frames, int frame_count)
{
    static const double BALL = 1.5; // the diameter of a ball, relative to its mean chord
    struct truth_lengths lengths;

    if (scene->counts_voxels || !isfinite(scene->path_length)) return;
    lengths = truth_lengths_find(scene->job, frames, frame_count);
    if (lengths.camera > 0.0) scene->camera_length = fmin(scene->camera_length, BALL * lengths.camera);
    if (lengths.light > 0.0) scene->light_length = fmin(scene->light_length, BALL * lengths.light);
}

#define SCATTER_AXES PLAN_AXIS_SCATTER_GRID, PLAN_AXIS_NODE_PATHS

// Families that usually need less work stand first.
const struct plan_family plan_families[] = {
    {"equiangular", JOB_METHOD_EQUIANGULAR, 0, serves_even, {PLAN_AXIS_POINTS, PLAN_AXIS_PATHS, SCATTER_AXES}, 4},
    {"cached with baked densities",
     JOB_METHOD_CACHED,
     0,
     serves_baked,
     {PLAN_AXIS_STEP, PLAN_AXIS_LIGHT_GRID, PLAN_AXIS_DENSITY_GRID, PLAN_AXIS_MIN_TRANSMITTANCE, PLAN_AXIS_PATHS,
      SCATTER_AXES},
     7},
    {"cached",
     JOB_METHOD_CACHED,
     0,
     serves_lit,
     {PLAN_AXIS_STEP, PLAN_AXIS_LIGHT_GRID, PLAN_AXIS_MIN_TRANSMITTANCE, PLAN_AXIS_PATHS, SCATTER_AXES},
     6},
    {"preintegrated",
     JOB_METHOD_PREINTEGRATED,
     0,
     serves_transfer,
     {PLAN_AXIS_STEP, PLAN_AXIS_LIGHT_STEP, PLAN_AXIS_MIN_TRANSMITTANCE, PLAN_AXIS_PATHS},
     4},
    {"gauss of order 2",
     JOB_METHOD_GAUSS,
     2,
     serves_marched,
     {PLAN_AXIS_STEP, PLAN_AXIS_LIGHT_STEP, PLAN_AXIS_MIN_TRANSMITTANCE, PLAN_AXIS_PATHS, SCATTER_AXES},
     6},
    {"adaptive",
     JOB_METHOD_ADAPTIVE,
     0,
     serves_marched,
     {PLAN_AXIS_STEP, PLAN_AXIS_LIGHT_STEP, PLAN_AXIS_DEPTH_STEP, PLAN_AXIS_MIN_TRANSMITTANCE, PLAN_AXIS_PATHS,
      SCATTER_AXES},
     7},
    {"midpoint",
     JOB_METHOD_MIDPOINT,
     0,
     serves_marched,
     {PLAN_AXIS_STEP, PLAN_AXIS_LIGHT_STEP, PLAN_AXIS_MIN_TRANSMITTANCE, PLAN_AXIS_PATHS, SCATTER_AXES},
     6},
    {"paths by light grids", JOB_METHOD_PATHS, 0, serves_path_grids, {PLAN_AXIS_PIXEL_PATHS, PLAN_AXIS_LIGHT_GRID}, 2},
    {"paths", JOB_METHOD_PATHS, 0, serves_scattered, {PLAN_AXIS_PIXEL_PATHS}, 1},
};
const size_t plan_family_count = sizeof plan_families / sizeof *plan_families;

static bool matters(enum plan_axis axis, const struct plan_scene *scene)
{
    switch (axis) {
    case PLAN_AXIS_LIGHT_STEP:
    case PLAN_AXIS_LIGHT_GRID:
        return scene->has_lights && !scene->is_even;
    case PLAN_AXIS_POINTS:
        return scene->has_lights && scene->has_media;
    case PLAN_AXIS_DEPTH_STEP:
    case PLAN_AXIS_MIN_TRANSMITTANCE:
        return scene->has_extinction;
    case PLAN_AXIS_PATHS:
        return scene->has_paths;
    case PLAN_AXIS_SCATTER_GRID:
    case PLAN_AXIS_NODE_PATHS:
    case PLAN_AXIS_PIXEL_PATHS:
        return scene->is_scattered;
    case PLAN_AXIS_STEP:
    case PLAN_AXIS_DENSITY_GRID:
        break;
    }
    return true;
}

int plan_family_axes(const struct plan_family *family, const struct plan_scene *scene,
                     enum plan_axis axes[static PLAN_AXIS_LIMIT])
{
    int count = 0;

    for (int i = 0; i < family->axis_count; i++)
        if (matters(family->axes[i], scene)) axes[count++] = family->axes[i];
    return count;
}

int plan_axis_last_rung(enum plan_axis axis, const struct plan_scene *scene)
{
    (void)scene;
    switch (axis) {
    case PLAN_AXIS_STEP:
    case PLAN_AXIS_LIGHT_STEP:
        return STEP_RUNGS - 1;
    case PLAN_AXIS_DEPTH_STEP:
        return DEPTH_RUNGS - 1;
    case PLAN_AXIS_POINTS:
        return COUNT(points) - 1;
    case PLAN_AXIS_LIGHT_GRID:
        return COUNT(grids) - 1;
    case PLAN_AXIS_DENSITY_GRID:
        return UNBAKED_RUNG;
    case PLAN_AXIS_MIN_TRANSMITTANCE:
        return TRANSMITTANCE_RUNGS - 1;
    case PLAN_AXIS_PATHS:
        return PATH_RUNGS - 1;
    case PLAN_AXIS_SCATTER_GRID:
        return SCATTER_GRID_RUNGS - 1;
    case PLAN_AXIS_NODE_PATHS:
    case PLAN_AXIS_PIXEL_PATHS:
        return SCATTER_PATH_RUNGS - 1;
    }
    return 0;
}

static double halved(double first, int rung)
{
    return first * exp2(-0.5 * rung);
}

static void set_axis(struct job_quality *quality, enum plan_axis axis, const struct plan_scene *scene, int rung)
{
    double step = halved(scene->counts_voxels ? VOXELS_FIRST : scene->path_length / FIRST_STEPS, rung);

    switch (axis) {
    case PLAN_AXIS_STEP:
        *(scene->counts_voxels ? &quality->step_voxels : &quality->step) = step;
        break;
    case PLAN_AXIS_LIGHT_STEP:
        *(scene->counts_voxels ? &quality->light_step_voxels : &quality->light_step) = step;
        break;
    case PLAN_AXIS_DEPTH_STEP:
        quality->depth_step = halved(DEPTH_FIRST, rung);
        break;
    case PLAN_AXIS_POINTS:
        quality->points = points[rung];
        break;
    case PLAN_AXIS_LIGHT_GRID:
        quality->light_grid = grids[rung];
        break;
    case PLAN_AXIS_DENSITY_GRID:
        quality->density_grid = rung < UNBAKED_RUNG ? grids[rung] : 0;
        break;
    case PLAN_AXIS_MIN_TRANSMITTANCE:
        quality->min_transmittance = rung < TRANSMITTANCE_RUNGS - 1 ? TRANSMITTANCE_FIRST * pow(4.0, -rung) : 0.0;
        break;
    case PLAN_AXIS_PATHS:
        quality->min_throughput = scene->job->quality.min_throughput * pow(4.0, -rung);
        quality->max_depth = scene->job->quality.max_depth + 2 * rung;
        if (quality->max_depth > JOB_DEPTH_LIMIT) quality->max_depth = JOB_DEPTH_LIMIT;
        break;
    case PLAN_AXIS_SCATTER_GRID:
        quality->scatter_grid = scatter_grid_cells[rung];
        quality->similar_after = plan_similar_after(scene->job);
        break;
    case PLAN_AXIS_NODE_PATHS:
    case PLAN_AXIS_PIXEL_PATHS:
        quality->paths = scatter_paths_of(rung);
        break;
    }
}

struct job_quality plan_family_quality(const struct plan_family *family, const struct plan_scene *scene,
                                       const struct plan_point *point)
{
    struct job_quality quality = scene->job->quality;
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_family_axes(family, scene, axes);

    quality.method = family->method;
    quality.order = family->order;
    if (family->method == JOB_METHOD_EQUIANGULAR) quality.points = 1;
    for (int i = 0; i < count; i++)
        set_axis(&quality, axes[i], scene, point->rungs[i]);
    if (point->is_from_lights && quality.scatter_grid > 0) {
        quality.scatter_from = JOB_SCATTER_FROM_LIGHTS;
        quality.similar_after = 0;
    }
    // A job that has lights needs a light_step even where nothing scatters their light, if its method has one.
    if (scene->job->scene.light_count > 0 && !scene->has_lights && family->method != JOB_METHOD_EQUIANGULAR &&
        family->method != JOB_METHOD_CACHED)
        set_axis(&quality, PLAN_AXIS_LIGHT_STEP, scene, 0);
    return quality;
}

void plan_family_add_seen(const struct plan_scene *scene, struct job_quality *quality)
{
    const struct job seen = job_layers_seen(scene->job);

    if (!serves_marched(scene) || !step_has_end(&seen)) return;
    set_axis(quality, PLAN_AXIS_STEP, scene,
             scene->counts_voxels ? SEEN_VOXELS_RUNG : SEEN_RUNG + 2 * scene->small_level);
}

bool plan_family_serves(const struct plan_family *family, const struct plan_scene *scene)
{
    struct json_node nowhere = json_node_root(NULL);
    struct plan_point middle = {.rungs = {8, 8, 8, 4, 0, 4, 4}};
    struct job planned = *scene->job;

    if (!family->serves(scene)) return false;
    planned.quality = plan_family_quality(family, scene, &middle);
    return step_check(&planned, &nowhere, NULL) &&
           (!scene->is_scattered || scattering_check_is_rendered(&planned, &nowhere, NULL));
}

// The rung at which a walk begins: steps that would keep the tolerance if all axes had equal steps.
static int start_rung(enum plan_axis axis, int level)
{
    switch (axis) {
    case PLAN_AXIS_STEP:
    case PLAN_AXIS_LIGHT_STEP:
        return 2 * level;
    case PLAN_AXIS_DEPTH_STEP:
        return 6;
    case PLAN_AXIS_POINTS:
        return 2 * level + 3;
    case PLAN_AXIS_LIGHT_GRID:
        return 4;
    case PLAN_AXIS_DENSITY_GRID:
        return 8;
    case PLAN_AXIS_MIN_TRANSMITTANCE:
        return 3;
    case PLAN_AXIS_SCATTER_GRID:
        return 6;
    case PLAN_AXIS_NODE_PATHS:
    case PLAN_AXIS_PIXEL_PATHS:
        return 16;
    case PLAN_AXIS_PATHS:
        break;
    }
    return 0;
}

struct plan_point plan_family_start(const struct plan_family *family, const struct plan_scene *scene, int level)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_family_axes(family, scene, axes);
    struct plan_point start = {.rungs = {0}};

    for (int i = 0; i < count; i++) {
        int rung = start_rung(axes[i], level), last = plan_axis_last_rung(axes[i], scene);

        start.rungs[i] = rung < last ? rung : last;
    }
    return start;
}

// Work of one evaluation of a density, relative to a fractal of eight folds. These weights and those below were set by
// hand from timings on software GL; docs/rendering.md says how far off they are.
static double density_work(const struct scene_density *density)
{
    switch (density->kind) {
    case SCENE_DENSITY_HOMOGENEOUS:
        return 0.1;
    case SCENE_DENSITY_FOLD_FRACTAL:
        return density->fold_fractal.iterations / 8.0;
    case SCENE_DENSITY_NOISE:
        return 1.0 * density->noise.octaves;
    case SCENE_DENSITY_GRID:
    case SCENE_DENSITY_GLSL:
        break;
    }
    return 1.0;
}

static double sum_density_work(const struct job *job, const struct job_quality *quality)
{
    static const double BAKED = 1.5; // a lookup in a baked grid
    double work = 0.1;               // of the step itself
    struct job planned = *job;
    struct density_bake bake;

    planned.quality = *quality;
    for (size_t i = 0; i < job->scene.medium_count; i++)
        work += density_bake_find(&bake, &planned, i) ? BAKED : density_work(&job->scene.media[i].density);
    return work;
}

// Work of the light that one step scatters. `density` is the work of all densities at one point, `depth` the ray's
// optical depth.
static double light_work(const struct plan_scene *scene, const struct job_quality *quality, double density,
                         double depth)
{
    static const double PHASE = 0.5, LOOKUP = 1.5;
    double light_step = scene->counts_voxels ? quality->light_step_voxels : quality->light_step, steps;

    if (!scene->has_lights) return 0.0;
    if (quality->method == JOB_METHOD_CACHED) return PHASE + LOOKUP;
    if (scene->is_even || light_step <= 0.0) return PHASE;
    steps = scene->light_length / light_step;
    if (quality->method == JOB_METHOD_ADAPTIVE) steps += LIGHT_SHARE * depth / quality->depth_step;
    if (quality->method == JOB_METHOD_GAUSS) steps *= quality->order;
    return PHASE + steps * density;
}

// Work of a camera ray of optical depth `depth`.
static double ray_work(const struct plan_scene *scene, const struct job_quality *quality, double density, double depth)
{
    double step = scene->counts_voxels ? quality->step_voxels : quality->step, share = 1.0, steps;
    double lights = (double)scene->job->scene.light_count;

    if (quality->min_transmittance > 0.0 && depth > 0.0) share = fmin(1.0, -log(quality->min_transmittance) / depth);
    steps = share * scene->camera_length / step;
    if (quality->method == JOB_METHOD_ADAPTIVE || (quality->method == JOB_METHOD_CACHED && quality->depth_step > 0.0))
        steps += share * depth / quality->depth_step;
    if (quality->method == JOB_METHOD_GAUSS) steps *= quality->order;
    if (quality->method == JOB_METHOD_PREINTEGRATED) density *= 1.5; // lookups in the table at both ends
    return steps * (density + lights * light_work(scene, quality, density, depth));
}

static double points_work(const struct plan_scene *scene, const struct job_quality *quality)
{
    const struct scene *light_scene = &scene->job->scene;
    double media = (double)light_scene->medium_count, lights = (double)light_scene->light_count;

    return media > 0.0 && lights > 0.0 ? quality->points * lights * (2.0 * media - 1.0) * (1.0 + 0.3 * media) : 0.0;
}

// Work of the light grids that are filled for each frame, divided by its pixels.
static double grid_work(const struct plan_scene *scene, const struct job_quality *quality, double density)
{
    static const double COLUMN = 16.0; // a node's sum over the nodes before it, which is bound by memory
    double lights = (double)scene->job->scene.light_count, samples = scene->pixels * quality->samples;

    if (quality->light_grid == 0 || !scene->has_lights) return 0.0;
    return lights * pow(quality->light_grid, 3) * (density + COLUMN) / samples;
}

// Work of the random paths of a frame, divided by its pixels.
static double scatter_work(const struct plan_scene *scene, const struct job_quality *quality, double density)
{
    static const double LOOKED_UP = 0.6; // what is left without flights to lights
    double each = quality->paths * scene->path_flights * (density + 1.0);

    if (quality->method == JOB_METHOD_PATHS) return quality->light_grid > 0 ? LOOKED_UP * each : each;
    if (quality->scatter_from == JOB_SCATTER_FROM_LIGHTS) each *= SCATTER_PARTICLE;
    return pow(quality->scatter_grid, 3) * each / (scene->pixels * quality->samples);
}

double plan_family_work(const struct plan_scene *scene, const struct job_quality *quality)
{
    static const double PIXEL = 5.0;
    double density = sum_density_work(scene->job, quality), sum = 0.0;

    if (quality->method == JOB_METHOD_EQUIANGULAR) {
        sum = points_work(scene, quality);
    } else if (quality->method != JOB_METHOD_PATHS) {
        for (size_t i = 0; i < scene->depth_count; i++)
            sum += ray_work(scene, quality, density, scene->depths[i]);
        sum /= scene->depth_count > 0 ? (double)scene->depth_count : 1.0;
    }
    // A smaller min_throughput cuts fewer paths, and each cut that is left out costs a little.
    if (scene->has_paths)
        sum *= 1.0 + 0.02 * log2(scene->job->quality.min_throughput / fmax(quality->min_throughput, 1e-9));
    return quality->samples * (PIXEL + scene->hit_share * sum + grid_work(scene, quality, density) +
                               (quality->paths > 0 ? scatter_work(scene, quality, density) : 0.0));
}
