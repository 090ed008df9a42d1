// SPDX-License-Identifier: Apache-2.0
#include "cli/chart/chart_ladder.h"

#include "cli/chart/chart_points.h"
#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FIRST_CELLS = 8, // on the lowest rung: steps in the scene's length, or voxels in a step
    GRID_LIMIT = 512,
    SAMPLE_LIMIT = 1024,
    FIRST_NODE_PATHS = 32,
    FIRST_PIXEL_PATHS = 4,
    LIGHT_STEPS_LIMIT = 60 * 1000,
    POINT_LIMIT = 1000,
    // Consecutive refused rungs that end a ladder.
    REFUSED_LIMIT = 3,
    // Consecutive rungs over which the error must fall to STALE_GAIN of its value.
    STALE_COUNT = 3
};
// min_transmittance on the lowest rung.
static const double FIRST_TRANSMITTANCE = 0.02;
static const double STALE_GAIN = 0.85;
// A picture is not tried when its expected time exceeds this multiple of the limit.
static const double FAR_BEYOND = 1.5;

const char CHART_PLANNED[] = "auto";

typedef void write_function(struct json_writer *out, int rung, const struct chart_scale *scale);

static double scale_step(const struct chart_scale *scale, double rung)
{
    double first = scale->voxel > 0 ? scale->voxel * FIRST_CELLS : scale->length / FIRST_CELLS;

    return first * exp2(-rung);
}

static int count_up(double first, double rung, int limit)
{
    return (int)fmin(round(first * exp2(rung)), limit);
}

// `order` 2: the error is proportional to the square of the step; 1: to the step.
static void write_min_transmittance(struct json_writer *out, int rung, int order)
{
    json_write_number_member(out, "min_transmittance", FIRST_TRANSMITTANCE * exp2(-(double)order * rung));
}

static void write_riemann(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    json_write_number_member(out, "step", fmin(scale_step(scale, rung), scale->far - scale->near));
    json_write_integer_member(out, "light_steps", count_up(FIRST_CELLS, rung, LIGHT_STEPS_LIMIT));
    write_min_transmittance(out, rung, 1);
}

static void write_steps(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    json_write_number_member(out, "step", scale_step(scale, rung));
    json_write_number_member(out, "light_step", 2 * scale_step(scale, rung));
    write_min_transmittance(out, rung, 2);
}

static void write_points(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    json_write_integer_member(out, "points", count_up(1, rung, POINT_LIMIT));
}

static void write_adaptive(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    write_steps(out, rung, scale);
    json_write_number_member(out, "depth_step", exp2(-rung));
}

static void write_gauss_2(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    write_steps(out, rung, scale);
    json_write_integer_member(out, "order", 2);
}

static void write_gauss_4(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    write_steps(out, rung, scale);
    json_write_integer_member(out, "order", 4);
}

// A light's grid has two cells in a step: linear interpolation in it is the largest error.
static void write_cached(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    double half = rung / 2.0;

    json_write_number_member(out, "step", scale_step(scale, half));
    json_write_number_member(out, "min_transmittance", FIRST_TRANSMITTANCE * exp2(-rung));
    json_write_integer_member(out, "light_grid", count_up(2.0 * FIRST_CELLS, half, GRID_LIMIT));
}

static void write_baked(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    write_cached(out, rung, scale);
    json_write_integer_member(out, "density_grid", count_up(2.0 * FIRST_CELLS, rung / 2.0, GRID_LIMIT));
}

static void write_tracking(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    json_write_string_member(out, "estimator", "ratio");
    (void)scale;
    json_write_integer_member(out, "samples", count_up(1, rung, SAMPLE_LIMIT));
}

// Of light above order 1. Cells err by their square, and paths by the root of their number, which nodes beside each
// other share.
static void write_scatter_grid(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    write_cached(out, rung, scale);
    json_write_integer_member(out, "scatter_grid", count_up(FIRST_CELLS, rung / 2.0, JOB_SCATTER_GRID_LIMIT));
    json_write_integer_member(out, "paths", count_up(FIRST_NODE_PATHS, 1.5 * rung, JOB_PATH_LIMIT));
}

// The error halves from rung to rung.
static void write_paths(struct json_writer *out, int rung, const struct chart_scale *scale)
{
    (void)scale;
    json_write_integer_member(out, "paths", count_up(FIRST_PIXEL_PATHS, 2.0 * rung, JOB_PATH_LIMIT));
}

static const struct series {
    const char *name, *method;
    write_function *write;
    // Only PLAIN series render scenes with objects. HAS_SAMPLES: the free number is that of samples.
    enum { PLAIN, NEEDS_CLIP, HAS_SAMPLES } kind;
    const char *base; // see chart_ladder_base; NULL: none
} all_series[] = {
    {"riemann", "riemann", write_riemann, NEEDS_CLIP, NULL},
    {"midpoint", "midpoint", write_steps, PLAIN, NULL},
    {"jittered", "jittered", write_steps, PLAIN, NULL},
    {"equiangular", "equiangular", write_points, PLAIN, NULL},
    {"adaptive", "adaptive", write_adaptive, PLAIN, NULL},
    {"gauss 2", "gauss", write_gauss_2, PLAIN, NULL},
    {"gauss 4", "gauss", write_gauss_4, PLAIN, NULL},
    {"cached", "cached", write_cached, PLAIN, NULL},
    {"cached baked", "cached", write_baked, PLAIN, "cached"},
    {"preintegrated", "preintegrated", write_steps, PLAIN, "midpoint"},
    {"scatter grid", "cached", write_scatter_grid, PLAIN, NULL},
    {"paths", "paths", write_paths, PLAIN, NULL},
    {"tracking", "tracking", write_tracking, HAS_SAMPLES, NULL},
};

enum { SERIES_COUNT = sizeof all_series / sizeof *all_series };

size_t chart_ladder_count(void)
{
    return SERIES_COUNT;
}

const char *chart_ladder_name(size_t series)
{
    return all_series[series].name;
}

const char *chart_ladder_method(size_t series)
{
    return all_series[series].method;
}

bool chart_ladder_needs_clip(size_t series)
{
    return all_series[series].kind == NEEDS_CLIP;
}

int chart_ladder_base(size_t series)
{
    for (size_t i = 0; all_series[series].base && i < SERIES_COUNT; i++)
        if (strcmp(all_series[i].name, all_series[series].base) == 0) return (int)i;
    return -1;
}

// Indices of the keys of a quality that are kept on all rungs.
enum { KEPT_ALL, KEPT_BUT_SAMPLES, KEPT_END = 4, KEPT_SAMPLES_END = 1 };

static void write_kept(struct json_writer *out, const struct json_node *quality, int first, int end)
{
    static const char *const kept[KEPT_END] = {"samples", "max_depth", "min_throughput", "max_cut"};

    for (int i = first; i < end; i++) {
        struct json_node member = json_node_child(quality, kept[i]);
        char *text;

        if (json_node_is_absent(&member)) continue;
        text = json_node_format(&member);
        json_write_key(out, kept[i]);
        json_write_raw(out, text, strlen(text));
        free(text);
    }
}

char *chart_ladder_quality(size_t series, int rung, const struct chart_scale *scale, const struct json_node *quality)
{
    const struct series *of = &all_series[series];
    struct json_writer out = {0};

    json_write_begin_object(&out);
    json_write_string_member(&out, "method", of->method);
    of->write(&out, rung, scale);
    write_kept(&out, quality, of->kind == HAS_SAMPLES ? KEPT_BUT_SAMPLES : KEPT_ALL,
               of->kind == PLAIN ? KEPT_END : KEPT_SAMPLES_END);
    json_write_end_object(&out);
    return out.text;
}

char *chart_ladder_tolerance(double tolerance, const struct json_node *quality)
{
    struct json_writer out = {0};

    json_write_begin_object(&out);
    json_write_number_member(&out, "tolerance", tolerance);
    write_kept(&out, quality, KEPT_ALL, KEPT_END);
    json_write_end_object(&out);
    return out.text;
}

// The least error of the rungs below `end`; INFINITY when none was measured.
static double find_least(const struct chart_points *points, const char *series, int end)
{
    double least = INFINITY;

    for (int rung = 0; rung < end; rung++) {
        const struct chart_point *point = chart_points_find(points, series, rung);

        if (point && point->outcome == CHART_MEASURED && point->error < least) least = point->error;
    }
    return least;
}

// Assumes that the time of a picture grows by the same factor from rung to rung.
static bool is_next_too_slow(const struct chart_point *before, const struct chart_point *point, double limit_s)
{
    return before && point->seconds > before->seconds &&
           point->seconds * point->seconds / before->seconds > FAR_BEYOND * limit_s;
}

int chart_ladder_next(const struct chart_points *points, size_t series, const struct chart_limits *limits)
{
    const char *name = all_series[series].name;
    const struct chart_point *before = NULL;
    int refused = 0, measured = 0;

    for (int rung = 0; rung < CHART_RUNG_LIMIT; rung++) {
        const struct chart_point *point = chart_points_find(points, name, rung);

        if (!point) return rung;
        if (point->outcome == CHART_TOO_SLOW) return -1;
        if (point->outcome == CHART_REFUSED) {
            if (measured > 0 || ++refused == REFUSED_LIMIT) return -1;
            continue;
        }
        measured++;
        refused = 0;
        if (point->error < limits->error || is_next_too_slow(before, point, limits->seconds)) return -1;
        before = point;
        if (measured > STALE_COUNT &&
            find_least(points, name, rung + 1) > STALE_GAIN * find_least(points, name, rung + 1 - STALE_COUNT))
            return -1;
    }
    return -1;
}

static bool is_known(const char *name)
{
    if (strcmp(name, CHART_PLANNED) == 0) return true;
    for (size_t i = 0; i < SERIES_COUNT; i++)
        if (strcmp(name, all_series[i].name) == 0 || strcmp(name, all_series[i].method) == 0) return true;
    return false;
}

// Takes over `text`, a name and an optional rung.
static bool add_name(struct chart_choice *choice, char *text, struct error *error)
{
    char *colon = strchr(text, ':'), *end = NULL;
    struct chart_choice_name *added;

    choice->names = xrealloc(choice->names, (choice->count + 1) * sizeof *choice->names);
    added = &choice->names[choice->count++];
    *added = (struct chart_choice_name){.name = text, .rung = -1};
    if (colon) {
        long rung = strtol(colon + 1, &end, 10);

        if (end == colon + 1 || *end || rung < 0 || rung >= CHART_RUNG_LIMIT) {
            error_set(error, "--methods: expected a rung in [0, %d] behind \"%.*s\", got \"%s\"", CHART_RUNG_LIMIT - 1,
                      (int)(colon - text), text, colon + 1);
            return false;
        }
        added->rung = (int)rung;
        *colon = 0;
    }
    if (is_known(text)) return true;
    error_set(error, "--methods: there is no method \"%s\"", text);
    return false;
}

bool chart_choice_parse(struct chart_choice *choice, const char *text, struct error *error)
{
    *choice = (struct chart_choice){0};
    for (;;) {
        size_t length = strcspn(text, ",");

        if (!add_name(choice, xstrndup(text, length), error)) {
            chart_choice_finish(choice);
            return false;
        }
        if (!text[length]) return true;
        text += length + 1;
    }
}

void chart_choice_finish(struct chart_choice *choice)
{
    for (size_t i = 0; i < choice->count; i++)
        free(choice->names[i].name);
    free(choice->names);
    *choice = (struct chart_choice){0};
}

int chart_choice_next(const struct chart_choice *choice, const struct chart_points *points, size_t series,
                      const struct chart_limits *limits)
{
    const struct series *of = &all_series[series];

    if (choice->count == 0 && limits->is_short && of->kind == HAS_SAMPLES) return -1;
    if (choice->count == 0) return chart_ladder_next(points, series, limits);
    for (size_t i = 0; i < choice->count; i++) {
        const struct chart_choice_name *name = &choice->names[i];

        if (strcmp(name->name, of->name) != 0 && strcmp(name->name, of->method) != 0) continue;
        if (name->rung < 0) return chart_ladder_next(points, series, limits);
        if (!chart_points_find(points, of->name, name->rung)) return name->rung;
    }
    return -1;
}

bool chart_choice_has_planned(const struct chart_choice *choice)
{
    for (size_t i = 0; i < choice->count; i++)
        if (strcmp(choice->names[i].name, CHART_PLANNED) == 0) return true;
    return choice->count == 0;
}
