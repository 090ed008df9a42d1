// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/interpolation_map.h"

#include "core/base/alloc.h"
#include "worker/audit/audit_random.h"
#include "worker/audit/audit_weight.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <math.h>
#include <stdlib.h>

// The shares of the draws. tests/light/interpolation_coverage_test measures the bounds that they lead to.
static const double SHARES[INTERPOLATION_COUNT] = {0.1, 0.4, 0.5};
static const uint64_t OTHER_DRAWS = 0x2545f4914f6cdd1du; // than those that are compared with reference/

static double weight_of(enum interpolation_strategy strategy, uint8_t doubt)
{
    return strategy == INTERPOLATION_DOUBTFUL ? (double)doubt * doubt : doubt > 0;
}

static size_t place_of(const struct image *image, struct pixel point)
{
    return (size_t)point.y * (size_t)image->width_px + (size_t)point.x;
}

void interpolation_map_init(struct interpolation_map *map, const struct image *image, enum job_pixel pixel)
{
    size_t width = (size_t)image->width_px, rows = (size_t)image->height_px;
    double sums[INTERPOLATION_COUNT] = {0.0}, squares = 0.0, shares = 0.0;

    *map = (struct interpolation_map){.image = image, .pixel = pixel};
    for (int strategy = INTERPOLATION_ALIKE; strategy < INTERPOLATION_COUNT; strategy++)
        map->sums[strategy] = xmalloc(rows * sizeof(double));
    for (size_t y = 0; y < rows; y++) {
        const uint8_t *doubts = image->doubts + y * width;
        uint64_t alike = 0, doubtful = 0;

        for (size_t x = 0; x < width; x++) {
            alike += doubts[x] > 0;
            doubtful += (uint64_t)doubts[x] * doubts[x];
        }
        map->sums[INTERPOLATION_ALIKE][y] = sums[INTERPOLATION_ALIKE] += (double)alike;
        map->sums[INTERPOLATION_DOUBTFUL][y] = sums[INTERPOLATION_DOUBTFUL] += (double)doubtful;
        squares += audit_weight_row(image, (int)y).squares;
    }
    map->mean_square = squares / ((double)width * (double)rows);
    for (int strategy = 0; strategy < INTERPOLATION_COUNT; strategy++) {
        map->share[strategy] = strategy == INTERPOLATION_ANY || sums[strategy] > 0.0 ? SHARES[strategy] : 0.0;
        shares += map->share[strategy];
    }
    map->share[INTERPOLATION_ANY] += 1.0 - shares;
}

void interpolation_map_finish(struct interpolation_map *map)
{
    for (int strategy = 0; strategy < INTERPOLATION_COUNT; strategy++)
        free(map->sums[strategy]);
    *map = (struct interpolation_map){0};
}

static double whole_of(const struct interpolation_map *map, enum interpolation_strategy strategy)
{
    return map->sums[strategy][map->image->height_px - 1];
}

double interpolation_map_density(const struct interpolation_map *map, struct pixel point)
{
    const struct image *image = map->image;
    uint8_t doubt = image->doubts[place_of(image, point)];
    double density = map->share[INTERPOLATION_ANY], count = (double)image->width_px * image->height_px;

    for (int i = INTERPOLATION_ALIKE; i < INTERPOLATION_COUNT; i++) {
        enum interpolation_strategy strategy = (enum interpolation_strategy)i;

        if (map->share[i] > 0.0)
            density += map->share[i] * count * weight_of(strategy, doubt) / whole_of(map, strategy);
    }
    return density;
}

static struct pixel draw_weighted(const struct interpolation_map *map, enum interpolation_strategy strategy,
                                  uint64_t *state)
{
    const double *rows = map->sums[strategy];
    int width = map->image->width_px, row = audit_random_step(rows, map->image->height_px, audit_random(state)), x = 0;
    const uint8_t *doubts = map->image->doubts + (size_t)row * (size_t)width;
    double wanted = audit_random(state) * (rows[row] - (row > 0 ? rows[row - 1] : 0.0)), sum = 0.0;

    for (x = 0; x < width - 1; x++) {
        sum += weight_of(strategy, doubts[x]);
        if (sum > wanted) break;
    }
    return (struct pixel){x, row};
}

static struct pixel draw_any(const struct interpolation_map *map, uint64_t *state)
{
    int x = (int)(audit_random(state) * map->image->width_px), y = (int)(audit_random(state) * map->image->height_px);

    return (struct pixel){x, y};
}

void interpolation_map_draw(const struct interpolation_map *map, const struct job *job, int32_t frame, size_t count,
                            struct pixel *points)
{
    uint64_t state = audit_random_seed(job, frame) ^ OTHER_DRAWS;

    for (size_t i = 0; i < count; i++) {
        double at = audit_random(&state);

        if (at < map->share[INTERPOLATION_ALIKE])
            points[i] = draw_weighted(map, INTERPOLATION_ALIKE, &state);
        else if (at < map->share[INTERPOLATION_ALIKE] + map->share[INTERPOLATION_DOUBTFUL])
            points[i] = draw_weighted(map, INTERPOLATION_DOUBTFUL, &state);
        else
            points[i] = draw_any(map, &state);
    }
}

struct audit_sample interpolation_map_compare(const struct interpolation_map *map, struct pixel point,
                                              const float *traced)
{
    const float *seen = &map->image->rgba[4 * place_of(map->image, point)];
    double unit = map->mean_square > AUDIT_BLACK * AUDIT_BLACK ? map->mean_square : 1.0;
    double weight = 1.0 / (3.0 * interpolation_map_density(map, point) * unit);
    struct audit_sample sample = {0};

    for (int c = 0; c < 3; c++) {
        double value = image_exr_stored(seen[c], map->pixel);
        double difference = value - image_exr_stored(traced[c], map->pixel);

        sample.square += weight * difference * difference;
        sample.cross += weight * value * difference;
    }
    return sample;
}
