// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/chart_truth.h"

#include "core/base/alloc.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "worker/audit/audit_map.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum {
    BATCH = 512,         // draws between two checks of the clock, at most
    PILOT = 64,          // the first draws, by which the time of a pixel is measured
    DRAWS_LIMIT = 200000 // more draws hardly lower the noise of the comparison
};

// Variance of the difference between picture and reference, relative to the picture's: the reference is the mean of two
// rays.
static const double NOISE_FACTOR = 1.5;

// The accuracy asked of random paths, relative: pixels are many, and the noise of their light counts nothing.
static const double PATHS_ACCURACY = 6e-3;
static const double LONG_S = 60.0; // a chart that gives its truth less time is a quick one

struct search {
    const struct chart_truth_params *params;
    struct truth *truth; // owned; NULL: `finest` is the truth
    struct audit_map map;
    struct integrate_accuracy accuracy;
    double end_s;
    struct chart_truth *found;
    size_t capacity;
    int *draws; // owned; the number of draws of each pixel
};

static bool is_wanted(void *user)
{
    const struct search *search = user;

    return clock_now_s() < search->end_s &&
           (!search->params->is_wanted || search->params->is_wanted(search->params->user));
}

static struct truth_pixel read_pixel(const struct image *image, struct pixel point)
{
    const float *value = &image->rgba[4 * ((size_t)point.y * (size_t)image->width_px + (size_t)point.x)];

    return (struct truth_pixel){.rgb = {value[0], value[1], value[2]}, .is_converged = true};
}

static size_t measure(const struct search *search, const struct pixel *points, struct truth_pixel *pixels, size_t count)
{
    if (search->truth)
        return truth_measure_many(search->truth, &(struct truth_many){.points = points,
                                                                      .pixels = pixels,
                                                                      .count = count,
                                                                      .accuracy = &search->accuracy,
                                                                      .on_progress = is_wanted,
                                                                      .user = (void *)search});
    for (size_t i = 0; i < count; i++)
        pixels[i] = read_pixel(search->params->finest, points[i]);
    return count;
}

static void add_pixel(struct search *search, struct pixel point, const struct truth_pixel *pixel)
{
    struct chart_truth *found = search->found;
    double variance = 0;

    for (int c = 0; c < 3; c++)
        variance += NOISE_FACTOR * pixel->variance[c] + pixel->half[c] * pixel->half[c];
    found->pixels = xgrow(found->pixels, &search->capacity, found->count + 1, sizeof *found->pixels);
    found->pixels[found->count++] =
        (struct chart_truth_pixel){point.x, point.y, 0, {pixel->rgb[0], pixel->rgb[1], pixel->rgb[2]}, variance};
}

static size_t index_of(const struct search *search, struct pixel point)
{
    return (size_t)point.y * (size_t)search->params->finer->width_px + (size_t)point.x;
}

// Measures the next draws, each pixel once. Returns the number of draws whose pixels are all measured.
static size_t measure_draws(struct search *search, size_t first, size_t count)
{
    struct pixel drawn[BATCH], fresh[BATCH];
    struct truth_pixel pixels[BATCH];
    size_t fresh_count = 0, measured, known = 0, seen = 0;

    audit_map_draw(&search->map, search->params->job, search->params->frame, first, count, drawn);
    for (size_t i = 0; i < count; i++)
        if (search->draws[index_of(search, drawn[i])]++ == 0) fresh[fresh_count++] = drawn[i];
    measured = measure(search, fresh, pixels, fresh_count);
    for (size_t i = 0; i < measured; i++)
        add_pixel(search, fresh[i], &pixels[i]);
    // If the batch was stopped, only the draws before the first unmeasured pixel count.
    for (; known < count; known++) {
        bool is_next = seen < fresh_count && drawn[known].x == fresh[seen].x && drawn[known].y == fresh[seen].y;

        if (is_next && seen++ == measured) break;
    }
    for (size_t i = known; i < count; i++)
        search->draws[index_of(search, drawn[i])]--;
    return first + known;
}

static void set_weights(struct search *search, size_t draw_count)
{
    struct chart_truth *found = search->found;
    double pixel_count = (double)search->params->finer->width_px * search->params->finer->height_px;

    for (size_t i = 0; i < found->count; i++) {
        struct pixel point = {found->pixels[i].x, found->pixels[i].y};

        found->pixels[i].weight = search->draws[index_of(search, point)] * pixel_count /
                                  ((double)draw_count * audit_map_density(&search->map, point));
    }
}

// Measures every pixel, each with weight 1.
static bool measure_all(struct search *search)
{
    int width = search->params->finer->width_px, height = search->params->finer->height_px;
    struct pixel *points = xcalloc((size_t)width, sizeof *points);
    struct truth_pixel *pixels = xcalloc((size_t)width, sizeof *pixels);
    bool ok = true;

    search->found->count = 0;
    for (int y = 0; y < height && ok; y++) {
        for (int x = 0; x < width; x++)
            points[x] = (struct pixel){x, y};
        ok = measure(search, points, pixels, (size_t)width) == (size_t)width;
        for (int x = 0; x < width && ok; x++) {
            add_pixel(search, points[x], &pixels[x]);
            search->found->pixels[search->found->count - 1].weight = 1;
        }
    }
    free(points);
    free(pixels);
    return ok;
}

static bool find(struct search *search, struct error *error)
{
    const struct chart_truth_params *params = search->params;
    double start_s = clock_now_s(), pixel_s, pixel_count = (double)params->finer->width_px * params->finer->height_px;
    size_t count;

    search->end_s = start_s + params->seconds;
    count = measure_draws(search, 0, PILOT);
    pixel_s = (clock_now_s() - start_s) / (double)(search->found->count + 1);
    if (count == PILOT && pixel_count <= DRAWS_LIMIT && pixel_s * pixel_count <= 0.9 * params->seconds) {
        search->end_s = INFINITY; // importance drew the pilot's pixels, which take longer than most
        if (measure_all(search)) return true;
    } else {
        while (count < DRAWS_LIMIT && is_wanted(search)) {
            size_t known = measure_draws(search, count, BATCH);
            bool is_whole = known == count + BATCH;

            count = known;
            if (!is_whole) break;
        }
        set_weights(search, count);
    }
    search->end_s = INFINITY;
    if (is_wanted(search) && count >= PILOT) return true;
    error_set(error, "expected time for the truth of %d pixels, got %g s, in which there were %zu%s", PILOT,
              params->seconds, count, params->seconds < LONG_S ? "; without --quick there is more" : "");
    return false;
}

bool chart_truth_find(struct chart_truth *truth, const struct chart_truth_params *params, struct error *error)
{
    struct search search = {.params = params, .found = truth};
    bool ok = true;

    *truth = (struct chart_truth){0};
    snprintf(truth->kind, sizeof truth->kind, "%s", params->finest ? "midpoint" : "reference");
    if (!params->finest) {
        search.truth = truth_open(&(struct truth_params){.job = params->job, .frame = params->frame}, error);
        ok = search.truth != NULL;
    }
    if (ok) {
        double rms;

        audit_map_init(&search.map, &(struct audit_map_params){.image = params->finer,
                                                               .pixel = params->job->output.pixel,
                                                               .finer = params->finer,
                                                               .coarser = params->coarser});
        rms = sqrt(search.map.mean_square);
        if (truth_is_random(params->job)) search.accuracy.relative = PATHS_ACCURACY;
        search.accuracy.floor = audit_map_floor(isfinite(rms) ? rms : 0.0);
        search.draws =
            xcalloc((size_t)params->finer->width_px * (size_t)params->finer->height_px, sizeof *search.draws);
        ok = find(&search, error);
        free(search.draws);
        audit_map_finish(&search.map);
    }
    truth_close(search.truth);
    if (!ok) chart_truth_finish(truth);
    return ok;
}
