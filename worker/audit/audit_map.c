// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/audit_map.h"

#include "core/base/alloc.h"
#include "worker/audit/audit_random.h"
#include "worker/audit/audit_weight.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Four standard errors, as variances.
static const double NOISE_LIMIT = 16.0;

// The shares of a map, relative to the sum of those that it has. tests/light/audit_coverage_test and audit_cut_test
// measure the bounds that they lead to; docs/rendering.md compares them with uniform draws.
static const double SHARES[AUDIT_STRATEGY_COUNT] = {0.25, 0.15, 0.1, 0.15, 0.3, 0.2};

// True for strategies that weigh pixels; the others weigh blocks.
static bool is_of_pixels(enum audit_strategy strategy)
{
    return strategy >= AUDIT_STRATEGY_BRIGHT && strategy <= AUDIT_STRATEGY_CUT;
}

static double weight_of(const struct audit_map *map, enum audit_strategy strategy, size_t pixel)
{
    if (strategy == AUDIT_STRATEGY_SPIKE) return audit_weight_spike(map->image, pixel);
    if (strategy == AUDIT_STRATEGY_CUT) return audit_weight_cut(map->image, pixel);
    return audit_weight_square(map->image, pixel);
}

static void sum_rows(struct audit_map *map)
{
    size_t width = (size_t)map->image->width_px, height = (size_t)map->image->height_px;
    double squares = 0.0, spikes = 0.0, cuts = 0.0;

    for (int strategy = AUDIT_STRATEGY_BRIGHT; strategy <= AUDIT_STRATEGY_CUT; strategy++)
        map->sums[strategy] = xcalloc(height, sizeof(double));
    for (size_t y = 0; y < height; y++) {
        struct audit_weight_row row = audit_weight_row(map->image, (int)y);

        squares += row.squares;
        spikes += row.spikes;
        cuts += row.cuts;
        map->brightest = fmaxf(map->brightest, row.brightest);
        map->sums[AUDIT_STRATEGY_BRIGHT][y] = squares;
        map->sums[AUDIT_STRATEGY_SPIKE][y] = spikes;
        map->sums[AUDIT_STRATEGY_CUT][y] = cuts;
    }
    map->mean_square = squares / ((double)width * (double)height);
    if (!isfinite(image_exr_stored(map->brightest, map->pixel))) map->mean_square = INFINITY;
}

// The first pixel whose centre is in block i of `count` blocks.
static int block_begin(int i, int count, int size_px)
{
    int64_t twice = 2 * (int64_t)i * size_px - count;

    return twice <= 0 ? 0 : (int)((twice + 2 * (int64_t)count - 1) / (2 * (int64_t)count));
}

static int block_of(int x, int count, int size_px)
{
    return (int)((2 * (int64_t)x + 1) * count / (2 * (int64_t)size_px));
}

static int block_pixels(const struct audit_map *map, int column, int row)
{
    int width = map->image->width_px, height = map->image->height_px;

    return (block_begin(column + 1, map->columns_count, width) - block_begin(column, map->columns_count, width)) *
           (block_begin(row + 1, map->rows_count, height) - block_begin(row, map->rows_count, height));
}

static double squared_difference(const float *a, const float *b)
{
    double sum = 0.0;

    for (int c = 0; c < 3; c++)
        sum += ((double)a[c] - b[c]) * ((double)a[c] - b[c]) / 3.0;
    return sum;
}

// The mean of the frame's pixels in each block, 4 values each as in an image. Free the result.
static float *find_block_means(const struct audit_map *map)
{
    const struct image *image = map->image;
    size_t count = (size_t)map->columns_count * (size_t)map->rows_count;
    double *sums = xcalloc(3 * count, sizeof *sums);
    float *means = xcalloc(4 * count, sizeof *means);

    for (int y = 0; y < image->height_px; y++) {
        size_t row = (size_t)block_of(y, map->rows_count, image->height_px) * (size_t)map->columns_count;

        for (int x = 0; x < image->width_px; x++) {
            double *sum = &sums[3 * (row + (size_t)block_of(x, map->columns_count, image->width_px))];
            const float *value = &image->rgba[4 * ((size_t)y * (size_t)image->width_px + (size_t)x)];

            for (int c = 0; c < 3; c++)
                sum[c] += value[c];
        }
    }
    for (size_t i = 0; i < count; i++) {
        int pixels = block_pixels(map, (int)(i % (size_t)map->columns_count), (int)(i / (size_t)map->columns_count));

        for (int c = 0; c < 3 && pixels > 0; c++)
            means[4 * i + c] = (float)(sums[3 * i + c] / pixels);
    }
    free(sums);
    return means;
}

static bool find_neighbour(const struct audit_map *map, int column, int row, int k, size_t *at)
{
    int i = column + k % 3 - 1, j = row + k / 3 - 1;

    if (i < 0 || i >= map->columns_count || j < 0 || j >= map->rows_count) return false;
    *at = (size_t)j * (size_t)map->columns_count + (size_t)i;
    return true;
}

// The two renders' difference in a block and, because it is known at only one point of the block, in its neighbours.
static double weigh_halving(const struct audit_map *map, int column, int row, const float *finer, const float *coarser)
{
    double weight = 0.0;
    size_t at;

    for (int k = 0; k < 9; k++)
        if (find_neighbour(map, column, row, k, &at))
            weight += squared_difference(&finer[4 * at], &coarser[4 * at]) * (k == 4 ? 0.5 : 0.0625);
    return weight;
}

// The squared distance of a block's mean from the range of the finer render around it. A mean and a point differ at
// edges, but both lie within that range.
static double weigh_odd(const struct audit_map *map, int column, int row, const float *finer, const float *means)
{
    const float *mean = &means[4 * ((size_t)row * (size_t)map->columns_count + (size_t)column)];
    double weight = 0.0;
    size_t at;

    for (int c = 0; c < 3; c++) {
        double low = INFINITY, high = -INFINITY, off;

        for (int k = 0; k < 9; k++) {
            if (!find_neighbour(map, column, row, k, &at)) continue;
            low = fmin(low, finer[4 * at + (size_t)c]);
            high = fmax(high, finer[4 * at + (size_t)c]);
        }
        off = fmax(fmax(low - mean[c], mean[c] - high), 0.0);
        weight += off * off / 3.0;
    }
    return weight;
}

typedef double block_weight(const struct audit_map *map, int column, int row, const float *a, const float *b);

static void sum_blocks(struct audit_map *map, enum audit_strategy strategy, block_weight *weigh, const float *a,
                       const float *b)
{
    int columns = map->columns_count, rows = map->rows_count;
    double sum = 0.0;

    map->sums[strategy] = xcalloc((size_t)columns * (size_t)rows, sizeof(double));
    for (int row = 0; row < rows; row++) {
        for (int column = 0; column < columns; column++) {
            sum += weigh(map, column, row, a, b) * block_pixels(map, column, row);
            map->sums[strategy][(size_t)row * (size_t)columns + (size_t)column] = sum;
        }
    }
}

static double mean_square_of(const struct image *a, const struct image *b)
{
    static const float NONE[3];
    size_t count = (size_t)a->width_px * (size_t)a->height_px;
    double sum = 0.0;

    for (size_t i = 0; i < count; i++)
        sum += squared_difference(&a->rgba[4 * i], b ? &b->rgba[4 * i] : NONE) / (double)count;
    return sum;
}

static void weigh_renders(struct audit_map *map, const struct audit_map_params *params)
{
    const struct image *finer = params->finer, *coarser = params->coarser;
    double square = mean_square_of(finer, NULL);

    map->columns_count = finer->width_px;
    map->rows_count = finer->height_px;
    sum_blocks(map, AUDIT_STRATEGY_HALVING, weigh_halving, finer->rgba, coarser->rgba);
    map->change = square > 0.0 ? sqrt(mean_square_of(finer, coarser) / square) : 0.0;
    if (params->is_own) {
        float *means = find_block_means(map);

        sum_blocks(map, AUDIT_STRATEGY_ODD, weigh_odd, finer->rgba, means);
        free(means);
    }
}

// The last of a strategy's running sums.
static double whole_of(const struct audit_map *map, enum audit_strategy strategy)
{
    size_t blocks = (size_t)map->columns_count * (size_t)map->rows_count;
    size_t count = is_of_pixels(strategy) ? (size_t)map->image->height_px : blocks;

    return map->sums[strategy] ? map->sums[strategy][count - 1] : 0.0;
}

static void share_out(struct audit_map *map)
{
    double sum = 0.0;

    for (int strategy = 0; strategy < AUDIT_STRATEGY_COUNT; strategy++) {
        double whole = strategy == AUDIT_STRATEGY_UNIFORM ? 1.0 : whole_of(map, (enum audit_strategy)strategy);

        // A sum is 0 where there is nothing to draw, and not finite in a broken frame.
        map->share[strategy] = whole > 0.0 && isfinite(whole) ? SHARES[strategy] : 0.0;
        sum += map->share[strategy];
    }
    for (int strategy = 0; strategy < AUDIT_STRATEGY_COUNT; strategy++)
        map->share[strategy] /= sum;
}

void audit_map_init(struct audit_map *map, const struct audit_map_params *params)
{
    *map = (struct audit_map){.image = params->image, .pixel = params->pixel, .change = -1.0};
    sum_rows(map);
    if (params->finer && params->coarser) weigh_renders(map, params);
    share_out(map);
}

void audit_map_finish(struct audit_map *map)
{
    for (int strategy = 0; strategy < AUDIT_STRATEGY_COUNT; strategy++)
        free(map->sums[strategy]);
    *map = (struct audit_map){0};
}

static double step_at(const double *sums, size_t i)
{
    return sums[i] - (i > 0 ? sums[i - 1] : 0.0);
}

double audit_map_floor(double rms)
{
    static const double DARK_SHARE = 0.1; // docs/rendering.md has the errors that it leaves

    return fmax(DARK_SHARE * rms, AUDIT_BLACK);
}

bool audit_map_is_black(const struct audit_map *map)
{
    return map->brightest < (float)AUDIT_BLACK;
}

double audit_map_density(const struct audit_map *map, struct pixel point)
{
    const struct image *image = map->image;
    size_t pixel = (size_t)point.y * (size_t)image->width_px + (size_t)point.x, block = 0;
    double density = map->share[AUDIT_STRATEGY_UNIFORM], count = (double)image->width_px * image->height_px;
    int pixels = 1;

    if (map->columns_count > 0) {
        int column = block_of(point.x, map->columns_count, image->width_px);
        int row = block_of(point.y, map->rows_count, image->height_px);

        block = (size_t)row * (size_t)map->columns_count + (size_t)column;
        pixels = block_pixels(map, column, row);
    }
    for (int strategy = AUDIT_STRATEGY_BRIGHT; strategy < AUDIT_STRATEGY_COUNT; strategy++) {
        double own;

        if (map->share[strategy] == 0.0) continue;
        if (is_of_pixels((enum audit_strategy)strategy))
            own = weight_of(map, (enum audit_strategy)strategy, pixel);
        else
            own = step_at(map->sums[strategy], block) / pixels;
        density += map->share[strategy] * count * own / whole_of(map, (enum audit_strategy)strategy);
    }
    return density;
}

// The squared difference less the noise of the reference, and of random normals in both; 0 up to four standard errors
// of the latter.
static double square_beyond_noise(double difference, const struct truth_pixel *pixel, int c)
{
    double noise = pixel->variance[c] * (1.0 + pixel->share), square = difference * difference;

    // The product of the differences to the two halves of the reference: right on average, so that its noise counts
    // nothing, and possibly negative.
    square -= pixel->half[c] * pixel->half[c];
    if (noise == 0.0) return square;
    return square > NOISE_LIMIT * noise ? square - noise : 0.0;
}

struct audit_sample audit_map_compare(const struct audit_map *map, struct pixel point, const float *traced,
                                      const struct truth_pixel *pixel)
{
    const struct image *image = map->image;
    size_t at = (size_t)point.y * (size_t)image->width_px + (size_t)point.x;
    const float *seen = traced ? traced : &image->rgba[4 * at];
    double unit = audit_map_is_black(map) ? 1.0 : map->mean_square;
    double weight = 1.0 / (3.0 * audit_map_density(map, point) * unit);
    struct audit_sample sample = {0};

    for (int c = 0; c < 3; c++) {
        double value = image_exr_stored(seen[c], map->pixel), difference = value - pixel->rgb[c];

        sample.square += weight * square_beyond_noise(difference, pixel, c);
        sample.cross += weight * value * difference;
        sample.noise += weight * pixel->variance[c];
    }
    return sample;
}

static int draw_between(int begin, int end, uint64_t *state)
{
    int at = begin + (int)(audit_random(state) * (end - begin));

    return at < end ? at : end - 1;
}

static struct pixel draw_in_row(const struct audit_map *map, enum audit_strategy strategy, uint64_t *state)
{
    const double *rows = map->sums[strategy];
    int width = map->image->width_px, row = audit_random_step(rows, map->image->height_px, audit_random(state)), x = 0;
    double wanted = audit_random(state) * step_at(rows, (size_t)row), sum = 0.0;

    for (x = 0; x < width - 1; x++) {
        sum += weight_of(map, strategy, (size_t)row * (size_t)width + (size_t)x);
        if (sum > wanted) break;
    }
    return (struct pixel){x, row};
}

static struct pixel draw_in_block(const struct audit_map *map, enum audit_strategy strategy, uint64_t *state)
{
    int width = map->image->width_px, height = map->image->height_px, columns = map->columns_count;
    int block = audit_random_step(map->sums[strategy], columns * map->rows_count, audit_random(state));
    int column = block % columns, row = block / columns;
    int left = block_begin(column, columns, width), right = block_begin(column + 1, columns, width);
    int top = block_begin(row, map->rows_count, height), bottom = block_begin(row + 1, map->rows_count, height);

    return (struct pixel){draw_between(left, right, state), draw_between(top, bottom, state)};
}

static struct pixel draw_point(const struct audit_map *map, enum audit_strategy strategy, uint64_t *state)
{
    struct pixel point = {0};

    switch (strategy) {
    case AUDIT_STRATEGY_BRIGHT:
    case AUDIT_STRATEGY_SPIKE:
    case AUDIT_STRATEGY_CUT:
        return draw_in_row(map, strategy, state);
    case AUDIT_STRATEGY_HALVING:
    case AUDIT_STRATEGY_ODD:
        return draw_in_block(map, strategy, state);
    default:
        break;
    }
    point.x = draw_between(0, map->image->width_px, state);
    point.y = draw_between(0, map->image->height_px, state);
    return point;
}

// The strategy of draw i. Multiples of the golden ratio fill the unit interval evenly, so any run of draws has nearly
// the strategies' shares.
static enum audit_strategy strategy_of(const struct audit_map *map, uint64_t seed, size_t i)
{
    double whole, at = modf((double)(i + 1) * 0.6180339887498949 + (double)(seed >> 11) * 0x1p-53, &whole);
    int strategy = 0;

    while (strategy < AUDIT_STRATEGY_COUNT - 1 && at >= map->share[strategy])
        at -= map->share[strategy++];
    while (strategy > 0 && map->share[strategy] == 0.0)
        strategy--;
    return (enum audit_strategy)strategy;
}

void audit_map_draw(const struct audit_map *map, const struct job *job, int32_t frame, size_t first, size_t count,
                    struct pixel *points)
{
    uint64_t seed = audit_random_seed(job, frame);

    for (size_t i = 0; i < count; i++) {
        uint64_t state = seed + (first + i) * 0xd1342543de82ef95u;

        points[i] = draw_point(map, strategy_of(map, seed, first + i), &state);
    }
}
