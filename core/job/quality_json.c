// SPDX-License-Identifier: Apache-2.0
#include "core/job/quality_json.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_write.h"

static const double STEP_MIN = 1e-9, STEP_MAX = 1e9;                              // m
static const double MIN_THROUGHPUT = 1e-3, MAX_CUT = 0.01, MAX_CUT_AUDITED = 1.0; // defaults
static const double TOLERANCE_DEFAULT = 0.01, TOLERANCE_MIN = 1e-4, TOLERANCE_MAX = 0.5;
static const double DEPTH_STEP_MIN = 1e-4, DEPTH_STEP_MAX = 100.0; // optical depth
static const double THRESHOLD_MIN = 1e-6;
enum { GRID_MIN = 4 };
static const double STEP_VOXELS_MIN = 1e-3, STEP_VOXELS_MAX = 1e3; // voxel edges

// Keys of all methods that take steps, and of all that render scenes with objects.
#define SCATTER_KEYS "scatter_grid", "scatter_from", "similar_after", "paths"
#define STEP_KEYS "method", "step", "step_voxels", "light_step", "light_step_voxels", "min_transmittance"
#define PATH_KEYS "samples", "max_depth", "min_throughput", "max_cut"

// A step is given in metres or in voxels; the other one stays 0.
struct step {
    const char *key, *voxels_key;
    double *metres, *voxels;
};

static bool read_step(const struct json_node *object, const struct step *step, struct error *error)
{
    struct json_node metres = json_node_child(object, step->key), voxels = json_node_child(object, step->voxels_key);

    if (json_node_is_absent(&voxels)) return json_read_number(&metres, STEP_MIN, STEP_MAX, step->metres, error);
    if (!json_node_is_absent(&metres))
        return json_fail(&voxels, error, "expected %s or %s, got both", step->key, step->voxels_key);
    return json_read_number(&voxels, STEP_VOXELS_MIN, STEP_VOXELS_MAX, step->voxels, error);
}

static bool read_optional_number(const struct json_node *object, const char *key, double max, double *number,
                                 struct error *error)
{
    struct json_node node = json_node_child(object, key);

    return json_node_is_absent(&node) || json_read_number(&node, 0.0, max, number, error);
}

static bool read_count(const struct json_node *object, const char *key, int64_t limit, int *count, struct error *error)
{
    struct json_node node = json_node_child(object, key);
    int64_t integer;

    if (!json_read_integer(&node, 1, limit, &integer, error)) return false;
    *count = (int)integer;
    return true;
}

static bool read_roulette(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    static const char *const keys[] = {"below", "survive", NULL};
    struct json_node roulette = json_node_child(object, "roulette");
    struct json_node below = json_node_child(&roulette, "below"), survive = json_node_child(&roulette, "survive");

    if (json_node_is_absent(&roulette)) return true;
    if (!json_check_object(&roulette, error) || !json_check_keys(&roulette, keys, error) ||
        !json_read_number(&below, 0.0, 1.0, &quality->roulette_below, error) ||
        !json_read_number(&survive, 0.0, 1.0, &quality->roulette_survive, error))
        return false;
    if (quality->roulette_below == 0.0) return json_fail_expected(&below, error, "a number in (0, 1]");
    if (quality->roulette_survive > 0.0 && quality->roulette_survive < 1.0) return true;
    return json_fail_expected(&survive, error, "a number in (0, 1)");
}

static bool read_pixels(const struct json_node *object, struct job_pixels *pixels, struct error *error)
{
    static const char *const keys[] = {"stride", "threshold", NULL};
    struct json_node node = json_node_child(object, "pixels");
    struct json_node stride = json_node_child(&node, "stride"), threshold = json_node_child(&node, "threshold");
    int64_t integer = JOB_STRIDE_DEFAULT;

    if (json_node_is_absent(&node)) return true;
    if (!json_check_object(&node, error) || !json_check_keys(&node, keys, error) ||
        (!json_node_is_absent(&stride) && !json_read_integer(&stride, 2, JOB_STRIDE_LIMIT, &integer, error)) ||
        !json_read_number(&threshold, THRESHOLD_MIN, 1.0, &pixels->threshold, error))
        return false;
    if ((integer & (integer - 1)) != 0) return json_fail_expected(&stride, error, "a power of two");
    pixels->stride = (int)integer;
    return true;
}

static bool read_riemann(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    static const char *const keys[] = {"method", "step", "light_steps", "min_transmittance", "samples", "pixels", NULL};
    struct json_node step = json_node_child(object, "step");

    return json_check_keys(object, keys, error) && json_read_number(&step, STEP_MIN, STEP_MAX, &quality->step, error) &&
           read_count(object, "light_steps", JOB_MARCH_STEPS_LIMIT, &quality->light_steps, error) &&
           read_optional_number(object, "min_transmittance", 1.0, &quality->min_transmittance, error);
}

// Reads the keys of methods that take steps: `step` along camera rays, optional `light_step` towards lights, and
// others.
static bool read_steps(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    const struct step step = {"step", "step_voxels", &quality->step, &quality->step_voxels};
    const struct step light_step = {"light_step", "light_step_voxels", &quality->light_step,
                                    &quality->light_step_voxels};
    struct json_node metres = json_node_child(object, light_step.key);
    struct json_node voxels = json_node_child(object, light_step.voxels_key);
    bool has_light_step = !json_node_is_absent(&metres) || !json_node_is_absent(&voxels);

    return read_step(object, &step, error) && (!has_light_step || read_step(object, &light_step, error)) &&
           read_optional_number(object, "min_transmittance", 1.0, &quality->min_transmittance, error) &&
           read_roulette(object, quality, error);
}

static bool read_midpoint(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    static const char *const keys[] = {STEP_KEYS, SCATTER_KEYS, "roulette", "pixels", PATH_KEYS, NULL};

    return json_check_keys(object, keys, error) && read_steps(object, quality, error);
}

static bool read_adaptive(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    static const char *const keys[] = {STEP_KEYS, SCATTER_KEYS, "depth_step", "roulette", "pixels", PATH_KEYS, NULL};
    struct json_node depth_step = json_node_child(object, "depth_step");

    return json_check_keys(object, keys, error) && read_steps(object, quality, error) &&
           json_read_number(&depth_step, DEPTH_STEP_MIN, DEPTH_STEP_MAX, &quality->depth_step, error);
}

static bool read_gauss(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    static const char *const keys[] = {STEP_KEYS, SCATTER_KEYS, "order", "pixels", PATH_KEYS, NULL};
    struct json_node order = json_node_child(object, "order");
    int64_t integer = 2;

    if (!json_check_keys(object, keys, error) || !read_steps(object, quality, error)) return false;
    if (!json_node_is_absent(&order) && !json_read_integer(&order, 2, JOB_ORDER_LIMIT, &integer, error)) return false;
    quality->order = (int)integer;
    return true;
}

static bool read_grid(const struct json_node *object, const char *key, int least, int *cells, struct error *error)
{
    struct json_node node = json_node_child(object, key);
    int64_t integer;

    if (!json_read_integer(&node, least, JOB_GRID_LIMIT, &integer, error)) return false;
    *cells = (int)integer;
    return true;
}

// With cached, lights have grids in place of light_step.
static bool read_cached(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    static const char *const keys[] = {
        "method",     "step",   "step_voxels", "light_grid", "depth_step", "density_grid", "min_transmittance",
        SCATTER_KEYS, "pixels", PATH_KEYS,     NULL};
    struct json_node depth_step = json_node_child(object, "depth_step");
    struct json_node density_grid = json_node_child(object, "density_grid");

    return json_check_keys(object, keys, error) && read_steps(object, quality, error) &&
           read_grid(object, "light_grid", GRID_MIN, &quality->light_grid, error) &&
           (json_node_is_absent(&density_grid) ||
            read_grid(object, "density_grid", GRID_MIN, &quality->density_grid, error)) &&
           (json_node_is_absent(&depth_step) ||
            json_read_number(&depth_step, DEPTH_STEP_MIN, DEPTH_STEP_MAX, &quality->depth_step, error));
}

static bool read_tracking(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    static const char *const keys[] = {"method", "estimator", "roulette", "samples", "pixels", NULL};
    static const char *const marched_keys[] = {
        "method",   "estimator", "step",   "step_voxels", "light_step", "light_step_voxels",
        "roulette", "samples",   "pixels", NULL};
    static const char *const estimators[] = {"delta", "ratio", "debiased", "jackknife", NULL};
    struct json_node estimator = json_node_child(object, "estimator");
    int choice;

    if (!json_read_enum(&estimator, estimators, &choice, error)) return false;
    quality->estimator = (enum job_estimator)choice;
    if (job_quality_has_majorants(quality))
        return json_check_keys(object, keys, error) && read_roulette(object, quality, error);
    return json_check_keys(object, marched_keys, error) && read_steps(object, quality, error);
}

// People write percents.
static bool read_tolerance(struct job_quality *quality, const struct json_node *node, struct error *error)
{
    double percent;

    if (json_read_number(node, TOLERANCE_MIN, TOLERANCE_MAX, &quality->tolerance, error)) return true;
    if (!json_read_number(node, 1.0, 100, &percent, NULL)) return false;
    return json_fail(node, error, "expected a number from %.15g to %.15g, got %g, did you mean %g (%g %%)?",
                     TOLERANCE_MIN, TOLERANCE_MAX, percent, percent / 100, percent);
}

static bool read_auto(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    static const char *const keys[] = {"method", "tolerance", "on_miss", PATH_KEYS, NULL};
    static const char *const choices[] = {"fail", "publish", NULL};
    struct json_node tolerance = json_node_child(object, "tolerance"), on_miss = json_node_child(object, "on_miss");
    int choice = JOB_ON_MISS_FAIL;

    quality->tolerance = TOLERANCE_DEFAULT;
    if (!json_check_keys(object, keys, error)) return false;
    if (!json_node_is_absent(&on_miss) && !json_read_enum(&on_miss, choices, &choice, error)) return false;
    quality->on_miss = (enum job_on_miss)choice;
    return json_node_is_absent(&tolerance) || read_tolerance(quality, &tolerance, error);
}

static bool read_equiangular(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    static const char *const keys[] = {"method", "points", SCATTER_KEYS, "pixels", PATH_KEYS, NULL};

    return json_check_keys(object, keys, error) &&
           read_count(object, "points", JOB_POINT_LIMIT, &quality->points, error);
}

// 0 cells are no grid.
static bool read_own_light_grid(const struct json_node *object, int *cells, struct error *error)
{
    struct json_node node = json_node_child(object, "light_grid");
    int64_t integer = 0;

    if (json_node_is_absent(&node)) return true;
    if (!json_read_integer(&node, 0, JOB_GRID_LIMIT, &integer, error)) return false;
    *cells = (int)integer;
    return integer == 0 || integer >= GRID_MIN || json_fail_expected(&node, error, "0 or 4 to 512 cells");
}

static bool read_random_paths(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    static const char *const keys[] = {"method", "paths",       "light_grid", "samples", "pixels",
                                       "step",   "step_voxels", "max_cut",    NULL};
    const struct step step = {"step", "step_voxels", &quality->step, &quality->step_voxels};
    struct json_node metres = json_node_child(object, step.key), voxels = json_node_child(object, step.voxels_key);
    bool has_step = !json_node_is_absent(&metres) || !json_node_is_absent(&voxels);

    return json_check_keys(object, keys, error) && (!has_step || read_step(object, &step, error)) &&
           read_own_light_grid(object, &quality->light_grid, error) &&
           read_count(object, "paths", JOB_PATH_LIMIT, &quality->paths, error);
}

// Without a method the planner chooses these keys.
static bool check_is_planned(const struct json_node *object, struct error *error)
{
    static const char *const keys[] = {
        "step",       "step_voxels", "light_step",   "light_step_voxels", "light_grid",        "density_grid",
        "depth_step", "order",       "points",       "light_steps",       "min_transmittance", "roulette",
        "pixels",     "paths",       "scatter_grid", "scatter_from",      "similar_after"};

    for (size_t i = 0; i < sizeof keys / sizeof *keys; ++i) {
        struct json_node node = json_node_child(object, keys[i]);

        if (!json_node_is_absent(&node))
            return json_fail(&node, error, "only beside a method; without one, the planner chooses it");
    }
    return true;
}

static bool read_method(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    const char *methods[JOB_METHOD_COUNT + 1];
    struct json_node method = json_node_child(object, "method");
    int choice = JOB_METHOD_AUTO;

    job_method_list(methods);
    if (json_node_is_absent(&method)) {
        if (!check_is_planned(object, error)) return false;
    } else if (!json_read_enum(&method, methods, &choice, error)) {
        return false;
    }
    quality->method = (enum job_method)choice;
    switch (quality->method) {
    case JOB_METHOD_RIEMANN:
        return read_riemann(object, quality, error);
    case JOB_METHOD_MIDPOINT:
    case JOB_METHOD_JITTERED:
    case JOB_METHOD_PREINTEGRATED:
        return read_midpoint(object, quality, error);
    case JOB_METHOD_EQUIANGULAR:
        return read_equiangular(object, quality, error);
    case JOB_METHOD_ADAPTIVE:
        return read_adaptive(object, quality, error);
    case JOB_METHOD_GAUSS:
        return read_gauss(object, quality, error);
    case JOB_METHOD_CACHED:
        return read_cached(object, quality, error);
    case JOB_METHOD_TRACKING:
        return read_tracking(object, quality, error);
    case JOB_METHOD_PATHS:
        return read_random_paths(object, quality, error);
    case JOB_METHOD_AUTO:
    case JOB_METHOD_DRAFT: // no name of a method
        return read_auto(object, quality, error);
    }
    return false;
}

// Reads the keys for scenes with objects.
static bool read_paths(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    struct json_node depth = json_node_child(object, "max_depth");
    struct json_node min_throughput = json_node_child(object, "min_throughput");
    struct json_node max_cut = json_node_child(object, "max_cut");

    if (!json_node_is_absent(&depth) && !read_count(object, "max_depth", JOB_DEPTH_LIMIT, &quality->max_depth, error))
        return false;
    if (!read_optional_number(object, "min_throughput", 1.0, &quality->min_throughput, error)) return false;
    if (quality->min_throughput >= 1.0) return json_fail_expected(&min_throughput, error, "a number in [0, 1)");
    // A bound on the light of traced rays says nothing about that of interpolated pixels.
    if (quality->pixels.stride > 0 && !json_node_is_absent(&max_cut))
        return json_fail(&max_cut, error, "not beside pixels: only the cut rays of traced pixels are known");
    quality->max_cut = quality->method == JOB_METHOD_AUTO ? MAX_CUT_AUDITED : MAX_CUT;
    return read_optional_number(object, "max_cut", 1.0, &quality->max_cut, error);
}

// A quick look takes one sample a pixel, and is never refused for cut light.
static bool read_draft(const struct json_node *text, struct job_quality *quality, struct error *error)
{
    static const char *const names[] = {"draft", NULL};
    int choice;

    if (!json_read_enum(text, names, &choice, error)) return false;
    quality->method = JOB_METHOD_DRAFT;
    quality->is_draft = true;
    quality->max_cut = 1.0;
    return true;
}

// In the order of enum job_scatter_from, after the first.
static const char *const scatter_froms[] = {"lights", "nodes", NULL};

static bool read_similar(const struct json_node *similar, const struct json_node *object, struct job_quality *quality,
                         struct error *error)
{
    if (json_node_is_absent(similar)) return true;
    if (quality->scatter_from == JOB_SCATTER_FROM_LIGHTS)
        return json_fail(similar, error, "not beside scatter_from \"lights\"");
    return read_count(object, "similar_after", JOB_SIMILAR_LIMIT, &quality->similar_after, error);
}

// Reads the keys of the grid of scattered light beside a march.
static bool read_scatter_grid(const struct json_node *object, struct job_quality *quality, struct error *error)
{
    struct json_node grid = json_node_child(object, "scatter_grid"), paths = json_node_child(object, "paths");
    struct json_node from = json_node_child(object, "scatter_from"), similar = json_node_child(object, "similar_after");
    int64_t cells;
    int choice = 0;

    if (quality->method == JOB_METHOD_PATHS) return true;
    if (json_node_is_absent(&grid))
        return (json_node_is_absent(&paths) || json_fail(&paths, error, "only beside scatter_grid")) &&
               (json_node_is_absent(&from) || json_fail(&from, error, "only beside scatter_grid")) &&
               (json_node_is_absent(&similar) || json_fail(&similar, error, "only beside scatter_grid"));
    if (!json_node_is_absent(&from)) {
        if (!json_read_enum(&from, scatter_froms, &choice, error)) return false;
        quality->scatter_from = JOB_SCATTER_FROM_LIGHTS + (enum job_scatter_from)choice;
    }
    if (!read_similar(&similar, object, quality, error) ||
        !json_read_integer(&grid, GRID_MIN, JOB_SCATTER_GRID_LIMIT, &cells, error))
        return false;
    quality->scatter_grid = (int)cells;
    quality->paths = JOB_PATH_DEFAULT;
    return json_node_is_absent(&paths) || read_count(object, "paths", JOB_PATH_LIMIT, &quality->paths, error);
}

bool quality_from_json(struct job_quality *quality, const struct json_node *document, struct error *error)
{
    struct json_node object = json_node_child(document, "quality"), samples = json_node_child(&object, "samples");

    *quality = (struct job_quality){.method = JOB_METHOD_AUTO,
                                    .tolerance = TOLERANCE_DEFAULT,
                                    .samples = 1,
                                    .max_depth = JOB_DEPTH_DEFAULT,
                                    .min_throughput = MIN_THROUGHPUT,
                                    .max_cut = MAX_CUT_AUDITED};
    if (json_node_is_absent(&object)) return true;
    quality->tolerance = 0.0;
    if (json_node_type(&object) == JSON_STRING) return read_draft(&object, quality, error);
    return json_check_object(&object, error) && read_method(&object, quality, error) &&
           (json_node_is_absent(&samples) ||
            read_count(&object, "samples", JOB_SAMPLE_LIMIT, &quality->samples, error)) &&
           read_scatter_grid(&object, quality, error) && read_pixels(&object, &quality->pixels, error) &&
           read_paths(&object, quality, error);
}

static void write_number(struct json_writer *writer, const char *key, double number)
{
    if (number > 0.0) json_write_number_member(writer, key, number);
}

static void write_count(struct json_writer *writer, const char *key, int count)
{
    if (count > 0) json_write_integer_member(writer, key, count);
}

static void write_pixels(struct json_writer *writer, const struct job_pixels *pixels)
{
    if (pixels->stride == 0) return;
    json_write_key(writer, "pixels");
    json_write_begin_object(writer);
    json_write_integer_member(writer, "stride", pixels->stride);
    json_write_number_member(writer, "threshold", pixels->threshold);
    json_write_end_object(writer);
}

void quality_to_json(struct json_writer *writer, const struct job *job, const struct job_quality *quality)
{
    json_write_begin_object(writer);
    json_write_string_member(writer, "method", job_method_name(quality->method));
    write_number(writer, "step", quality->step);
    write_number(writer, "step_voxels", quality->step_voxels);
    write_number(writer, "light_step", quality->light_step);
    write_number(writer, "light_step_voxels", quality->light_step_voxels);
    write_number(writer, "depth_step", quality->depth_step);
    write_count(writer, "order", quality->order);
    write_count(writer, "points", quality->points);
    write_count(writer, "light_grid", quality->light_grid);
    write_count(writer, "density_grid", quality->density_grid);
    write_count(writer, "scatter_grid", quality->scatter_grid);
    if (quality->scatter_from != JOB_SCATTER_FROM_ANY)
        json_write_string_member(writer, "scatter_from", scatter_froms[quality->scatter_from - 1]);
    write_count(writer, "similar_after", quality->similar_after);
    write_count(writer, "paths", quality->paths);
    write_number(writer, "min_transmittance", quality->min_transmittance);
    json_write_integer_member(writer, "samples", quality->samples);
    write_pixels(writer, &quality->pixels);
    if (job_limits_rays(job, quality)) {
        json_write_integer_member(writer, "max_depth", quality->max_depth);
        json_write_number_member(writer, "min_throughput", quality->min_throughput);
    }
    json_write_end_object(writer);
}
