#include "worker/audit_map.h"

#include "core/alloc.h"
#include "worker/image.h"
#include "worker/image_exr.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Of a map that has them all.
static const double SHARES[AUDIT_WAY_COUNT] = {0.25, 0.2, 0.35, 0.2};

static double square_of(const struct audit_map *map, size_t i)
{
    double sum = 0.0;

    for (size_t c = 0; c < 3; c++) {
        double value = image_exr_stored(map->image->rgba[4 * i + c], map->pixel);

        sum += value * value / 3.0;
    }
    return sum;
}

static void sum_rows(struct audit_map *map)
{
    size_t width = (size_t)map->image->width_px, height = (size_t)map->image->height_px;
    double sum = 0.0;

    map->rows = xcalloc(height, sizeof *map->rows);
    for (size_t y = 0; y < height; y++) {
        for (size_t x = 0; x < width; x++)
            sum += square_of(map, y * width + x);
        map->rows[y] = sum;
    }
    map->mean_square = sum / ((double)width * (double)height);
}

// Pixels with their centres in block i of `count` blocks begin here.
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

// The mean of the frame's pixels in each block, 4 values each as in an image.
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

// A block weighs by the pictures' difference there and, as that is known at one point alone, around it.
static void weigh_blocks(struct audit_map *map, enum audit_way way, const float *a, const float *b)
{
    int columns = map->columns_count, rows = map->rows_count;
    double sum = 0.0;

    map->blocks[way] = xcalloc((size_t)columns * (size_t)rows, sizeof *map->blocks[way]);
    for (int row = 0; row < rows; row++) {
        for (int column = 0; column < columns; column++) {
            double weight = 0.0;

            for (int k = 0; k < 9; k++) {
                int i = column + k % 3 - 1, j = row + k / 3 - 1;
                size_t at = (size_t)j * (size_t)columns + (size_t)i;

                if (i < 0 || i >= columns || j < 0 || j >= rows) continue;
                weight += squared_difference(&a[4 * at], &b[4 * at]) * (k == 4 ? 0.5 : 0.0625);
            }
            sum += weight * block_pixels(map, column, row);
            map->blocks[way][(size_t)row * (size_t)columns + (size_t)column] = sum;
        }
    }
    if (sum > 0.0 && isfinite(sum)) return;
    free(map->blocks[way]);
    map->blocks[way] = NULL;
}

static void find_change(struct audit_map *map, const struct image *finer, const struct image *coarser)
{
    double difference = 0.0, square = 0.0;

    for (size_t i = 0; i < (size_t)finer->width_px * (size_t)finer->height_px; i++) {
        static const float BLACK[3];

        difference += squared_difference(&finer->rgba[4 * i], &coarser->rgba[4 * i]);
        square += squared_difference(&finer->rgba[4 * i], BLACK);
    }
    map->change = square > 0.0 ? sqrt(difference / square) : 0.0;
}

static void share_out(struct audit_map *map)
{
    double sum = 0.0;

    for (int way = 0; way < AUDIT_WAY_COUNT; way++) {
        bool is_there =
            way == AUDIT_WAY_UNIFORM || (way == AUDIT_WAY_BRIGHT && map->mean_square > 0.0) || map->blocks[way] != NULL;

        map->share[way] = is_there ? SHARES[way] : 0.0;
        sum += map->share[way];
    }
    for (int way = 0; way < AUDIT_WAY_COUNT; way++)
        map->share[way] /= sum;
}

void audit_map_init(struct audit_map *map, const struct audit_map_params *params)
{
    *map = (struct audit_map){.image = params->image, .pixel = params->pixel, .change = -1.0};
    sum_rows(map);
    if (params->finer && params->coarser) {
        map->columns_count = params->finer->width_px;
        map->rows_count = params->finer->height_px;
        weigh_blocks(map, AUDIT_WAY_HALVING, params->finer->rgba, params->coarser->rgba);
        find_change(map, params->finer, params->coarser);
        if (params->is_own) {
            float *means = find_block_means(map);

            weigh_blocks(map, AUDIT_WAY_ODD, means, params->finer->rgba);
            free(means);
        }
    }
    share_out(map);
}

void audit_map_finish(struct audit_map *map)
{
    free(map->rows);
    for (int way = 0; way < AUDIT_WAY_COUNT; way++)
        free(map->blocks[way]);
    *map = (struct audit_map){0};
}

static double step_at(const double *sums, size_t i)
{
    return sums[i] - (i > 0 ? sums[i - 1] : 0.0);
}

double audit_map_density(const struct audit_map *map, struct truth_place place)
{
    const struct image *image = map->image;
    size_t pixel = (size_t)place.y * (size_t)image->width_px + (size_t)place.x, block = 0, last = 0;
    double density = map->share[AUDIT_WAY_UNIFORM], count = (double)image->width_px * image->height_px;
    int column, row;

    if (map->share[AUDIT_WAY_BRIGHT] > 0.0)
        density += map->share[AUDIT_WAY_BRIGHT] * square_of(map, pixel) / map->mean_square;
    if (map->columns_count == 0) return density;
    column = block_of(place.x, map->columns_count, image->width_px);
    row = block_of(place.y, map->rows_count, image->height_px);
    block = (size_t)row * (size_t)map->columns_count + (size_t)column;
    last = (size_t)map->columns_count * (size_t)map->rows_count - 1;
    for (int way = AUDIT_WAY_HALVING; way < AUDIT_WAY_COUNT; way++) {
        if (!map->blocks[way]) continue;
        density += map->share[way] * count * step_at(map->blocks[way], block) /
                   (map->blocks[way][last] * block_pixels(map, column, row));
    }
    return density;
}

// Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators, OOPSLA 2014.
static double draw(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;

    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

static uint64_t seed_of(const struct job *job, int32_t frame)
{
    uint64_t seed = 0xcbf29ce484222325u ^ (uint32_t)frame;

    for (const char *at = job->hash; *at; at++)
        seed = (seed ^ (unsigned char)*at) * 0x100000001b3u;
    return seed;
}

// The first of `count` running sums that is above `share` of the last one.
static int find_step(const double *sums, int count, double share)
{
    double wanted = share * sums[count - 1];
    int low = 0, high = count - 1;

    while (low < high) {
        int middle = low + (high - low) / 2;

        if (sums[middle] > wanted)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static int draw_between(int begin, int end, uint64_t *state)
{
    int at = begin + (int)(draw(state) * (end - begin));

    return at < end ? at : end - 1;
}

static struct truth_place draw_bright(const struct audit_map *map, uint64_t *state)
{
    int width = map->image->width_px, row = find_step(map->rows, map->image->height_px, draw(state)), x = 0;
    double wanted = draw(state) * step_at(map->rows, (size_t)row), sum = 0.0;

    for (x = 0; x < width - 1; x++) {
        sum += square_of(map, (size_t)row * (size_t)width + (size_t)x);
        if (sum > wanted) break;
    }
    return (struct truth_place){x, row};
}

static struct truth_place draw_in_block(const struct audit_map *map, enum audit_way way, uint64_t *state)
{
    int width = map->image->width_px, height = map->image->height_px, columns = map->columns_count;
    int block = find_step(map->blocks[way], columns * map->rows_count, draw(state));
    int column = block % columns, row = block / columns;

    return (struct truth_place){
        draw_between(block_begin(column, columns, width), block_begin(column + 1, columns, width), state),
        draw_between(block_begin(row, map->rows_count, height), block_begin(row + 1, map->rows_count, height), state)};
}

static struct truth_place draw_place(const struct audit_map *map, enum audit_way way, uint64_t *state)
{
    if (way == AUDIT_WAY_BRIGHT) return draw_bright(map, state);
    if (way != AUDIT_WAY_UNIFORM) return draw_in_block(map, way, state);
    return (struct truth_place){draw_between(0, map->image->width_px, state),
                                draw_between(0, map->image->height_px, state)};
}

// The ways follow one another so that any run of draws has their shares nearly: multiples of the golden ratio fill the unit
// interval evenly.
static enum audit_way way_of(const struct audit_map *map, uint64_t seed, size_t i)
{
    double whole, at = modf((double)(i + 1) * 0.6180339887498949 + (double)(seed >> 11) * 0x1p-53, &whole);
    int way = 0;

    while (way < AUDIT_WAY_COUNT - 1 && at >= map->share[way])
        at -= map->share[way++];
    while (map->share[way] == 0.0)
        way--;
    return (enum audit_way)way;
}

void audit_map_draw(const struct audit_map *map, const struct job *job, int32_t frame, size_t first, size_t count,
                    struct truth_place *places)
{
    uint64_t seed = seed_of(job, frame);

    for (size_t i = 0; i < count; i++) {
        uint64_t state = seed + (first + i) * 0xd1342543de82ef95u;

        places[i] = draw_place(map, way_of(map, seed, first + i), &state);
    }
}
