// SPDX-License-Identifier: Apache-2.0
#include "tests/support/nanovdb_maker.h"

#include "core/base/alloc.h"

#include <assert.h>
#include <blosc.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

// The format of a grid of floats; all numbers are little-endian.
enum {
    SEGMENT = 16,
    METADATA = 176,
    GRID = 672,
    TREE = 64,
    ROOT = 64,
    ROOT_TILE = 32,
    UPPER = 8256 + 32768 * 8,
    LOWER = 1088 + 4096 * 8,
    BLOSC_CHUNK = 1 << 20,
    UPPER_LIMIT = 16
};

static void put(unsigned char *at, const void *value, size_t size_bytes)
{
    memcpy(at, value, size_bytes);
}

static void put_u32(unsigned char *at, uint32_t value)
{
    put(at, &value, sizeof value);
}

static void put_u64(unsigned char *at, uint64_t value)
{
    put(at, &value, sizeof value);
}

static void put_bit(unsigned char *mask, unsigned n)
{
    mask[n / 8] = (unsigned char)(mask[n / 8] | 1U << n % 8);
}

struct making {
    const struct nanovdb_params *params;
    unsigned char *grid; // owned
    size_t grid_bytes;
    unsigned char *root, *uppers, *lowers, *leaves;
    size_t root_tile_count;
    struct upper_place {
        int voxel[3];        // some voxel in it
        int lower_of[32768]; // 0: none, else one more than its number
    } places[UPPER_LIMIT];
    size_t upper_count, lower_count, leaf_count;
    size_t leaf_bytes; // of all leaves so far
};

static unsigned upper_slot(const int voxel[3])
{
    return (unsigned)((voxel[0] & 4095) >> 7 << 10 | (voxel[1] & 4095) >> 7 << 5 | (voxel[2] & 4095) >> 7);
}

static unsigned lower_slot(const int voxel[3])
{
    return (unsigned)((voxel[0] & 127) >> 3 << 8 | (voxel[1] & 127) >> 3 << 4 | (voxel[2] & 127) >> 3);
}

static uint64_t root_key(const int voxel[3])
{
    return (uint64_t)((uint32_t)voxel[0] >> 12) << 42 | (uint64_t)((uint32_t)voxel[1] >> 12) << 21 |
           (uint32_t)voxel[2] >> 12;
}

// The index of the upper node of a voxel; appends a node when there is none.
static size_t upper_of(struct making *making, const int voxel[3])
{
    size_t i = 0;

    while (i < making->upper_count && root_key(making->places[i].voxel) != root_key(voxel))
        ++i;
    if (i == making->upper_count) {
        assert(i < UPPER_LIMIT);
        memcpy(making->places[i].voxel, voxel, sizeof making->places[i].voxel);
        ++making->upper_count;
    }
    return i;
}

static unsigned char *lower_at(struct making *making, const int voxel[3])
{
    int number = making->places[upper_of(making, voxel)].lower_of[upper_slot(voxel)];

    assert(number > 0);
    return making->lowers + (size_t)(number - 1) * LOWER;
}

static void need_lower(struct making *making, const int voxel[3])
{
    int *number = &making->places[upper_of(making, voxel)].lower_of[upper_slot(voxel)];

    if (*number == 0) *number = (int)++making->lower_count;
}

// Calls `visit` for the first voxel of each leaf that the active box touches.
static void each_leaf(struct making *making, void visit(struct making *making, const int origin[3]))
{
    const struct nanovdb_params *params = making->params;
    int origin[3];

    if (params->min[0] > params->max[0]) return;
    for (origin[0] = params->min[0] & ~7; origin[0] <= params->max[0]; origin[0] += 8)
        for (origin[1] = params->min[1] & ~7; origin[1] <= params->max[1]; origin[1] += 8)
            for (origin[2] = params->min[2] & ~7; origin[2] <= params->max[2]; origin[2] += 8)
                visit(making, origin);
}

static void count_leaf(struct making *making, const int origin[3])
{
    need_lower(making, origin);
    ++making->leaf_count;
}

static bool is_active(const struct nanovdb_params *params, const int voxel[3])
{
    for (int axis = 0; axis < 3; ++axis)
        if (voxel[axis] < params->min[axis] || voxel[axis] > params->max[axis]) return false;
    return true;
}

// The bits of a value of the latest leaf.
static unsigned bits_of(const struct making *making)
{
    int bits = making->params->bits;

    if (bits == 0) return 32;
    return bits > 0 ? (unsigned)bits : 1U << making->leaf_count % 5;
}

static unsigned type_of(const struct nanovdb_params *params)
{
    if (params->bits == 0) return 1;
    return params->bits == NANOVDB_MAKER_VARIABLE ? 16 : params->bits == 4 ? 13 : params->bits == 8 ? 14 : 15;
}

// Writes codes between the least and the greatest value.
static void write_codes(unsigned char *leaf, const float values[512], unsigned bits)
{
    float least = values[0], most = values[0], quantum;

    for (unsigned n = 0; n < 512; ++n) {
        least = fminf(least, values[n]);
        most = fmaxf(most, values[n]);
    }
    quantum = (most - least) / (float)((1U << bits) - 1);
    put(leaf + 80, &least, 4);
    put(leaf + 84, &quantum, 4);
    for (unsigned n = 0; n < 512; ++n) {
        unsigned code = quantum > 0 ? (unsigned)lrintf((values[n] - least) / quantum) : 0;

        for (unsigned bit = 0; bit < bits; ++bit)
            if (code >> bit & 1) put_bit(leaf + 96, n * bits + bit);
    }
}

static void write_leaf(struct making *making, const int origin[3])
{
    const struct nanovdb_params *params = making->params;
    unsigned char *leaf = making->leaves + making->leaf_bytes;
    unsigned char *lower = lower_at(making, origin);
    unsigned slot = lower_slot(origin), bits = bits_of(making);
    float values[512];

    put_bit(lower + 544, slot);
    put_u64(lower + 1088 + 8 * (size_t)slot, (uint64_t)(leaf - lower));
    put(leaf, origin, 12);
    for (unsigned n = 0; n < 512; ++n) {
        int voxel[3] = {origin[0] + (int)(n >> 6), origin[1] + (int)(n >> 3 & 7), origin[2] + (int)(n & 7)};

        values[n] = params->background;
        if (!is_active(params, voxel)) continue;
        values[n] = params->value(voxel);
        put_bit(leaf + 16, n);
    }
    if (params->bits == NANOVDB_MAKER_VARIABLE) leaf[15] = (unsigned char)(making->leaf_count % 5 << 5);
    if (params->bits == 0)
        put(leaf + 96, values, sizeof values);
    else
        write_codes(leaf, values, bits);
    ++making->leaf_count;
    making->leaf_bytes += 96 + 64 * (size_t)bits;
}

static void fill_upper(struct making *making, size_t i)
{
    const int *lower_of = making->places[i].lower_of;
    unsigned char *upper = making->uppers + i * UPPER;

    for (size_t n = 0; n < 32768; ++n) {
        put(upper + 8256 + 8 * n, &making->params->background, 4);
        if (lower_of[n] == 0) continue;
        put_bit(upper + 4128, (unsigned)n);
        put_u64(upper + 8256 + 8 * n, (uint64_t)(making->lowers + (size_t)(lower_of[n] - 1) * LOWER - upper));
    }
}

static void fill_tables(struct making *making)
{
    for (size_t i = 0; i < making->upper_count; ++i)
        fill_upper(making, i);
    for (size_t i = 0; i < making->lower_count; ++i)
        for (size_t n = 0; n < 4096; ++n)
            put(making->lowers + i * LOWER + 1088 + 8 * n, &making->params->background, 4);
}

static void write_root_tile(struct making *making, const int voxel[3], uint64_t child, const struct nanovdb_tile *tile)
{
    unsigned char *at = making->root + ROOT + making->root_tile_count++ * ROOT_TILE;

    put_u64(at, root_key(voxel));
    put_u64(at + 8, child);
    if (!tile) return;
    put_u32(at + 16, tile->is_active);
    put(at + 20, &tile->value, 4);
}

static void write_tile(struct making *making, const struct nanovdb_tile *tile)
{
    unsigned char *node;
    unsigned slot;

    if (tile->side == 4096) {
        write_root_tile(making, tile->origin, 0, tile);
        return;
    }
    node = tile->side == 128 ? making->uppers + upper_of(making, tile->origin) * UPPER : lower_at(making, tile->origin);
    slot = tile->side == 128 ? upper_slot(tile->origin) : lower_slot(tile->origin);
    if (tile->is_active) put_bit(node + 32, slot);
    put(node + (tile->side == 128 ? 8256 : 1088) + 8 * (size_t)slot, &tile->value, 4);
}

static void write_grid(struct making *making)
{
    const struct nanovdb_params *params = making->params;
    unsigned char *grid = making->grid, *tree = grid + GRID;

    put(grid, "NanoVDB0", 8);
    put_u32(grid + 16, 32U << 21 | 4U << 10 | 2U);
    put_u32(grid + 28, 1);
    put_u64(grid + 32, making->grid_bytes);
    memcpy(grid + 40, params->name, strlen(params->name));
    for (size_t row = 0; row < 3; ++row) {
        put(grid + 296 + 88 + 24 * row, &params->map[4 * row], 24);
        put(grid + 296 + 232 + 8 * row, &params->map[4 * row + 3], 8);
    }
    put_u32(grid + 632, 2); // fog volume
    put_u32(grid + 636, type_of(params));
    put_u64(tree, (uint64_t)(making->leaves - tree));
    put_u64(tree + 8, (uint64_t)(making->lowers - tree));
    put_u64(tree + 16, (uint64_t)(making->uppers - tree));
    put_u64(tree + 24, (uint64_t)(making->root - tree));
    put_u32(tree + 32, (uint32_t)making->leaf_count);
    put_u32(tree + 36, (uint32_t)making->lower_count);
    put_u32(tree + 40, (uint32_t)making->upper_count);
    put_u32(making->root + 24, (uint32_t)making->root_tile_count);
    put(making->root + 28, &params->background, 4);
}

// Returns the bytes that it wrote: chunks, each with its size before it.
static size_t write_blosc(unsigned char *at, const struct making *making)
{
    unsigned char *begin = at;

    for (size_t done = 0; done < making->grid_bytes; done += BLOSC_CHUNK) {
        size_t rest = making->grid_bytes - done, count = rest < BLOSC_CHUNK ? rest : BLOSC_CHUNK;
        int packed = blosc_compress_ctx(9, 1, 4, count, making->grid + done, at + 8, count + BLOSC_MAX_OVERHEAD, "lz4",
                                        1 << 18, 1);

        assert(packed > 0);
        put_u64(at, (uint64_t)packed);
        at += 8 + packed;
    }
    return (size_t)(at - begin);
}

static void write_file(struct nanovdb_made *made, const struct making *making)
{
    const struct nanovdb_params *params = making->params;
    size_t name_bytes = strlen(params->name) + 1;
    uLongf packed_bytes = compressBound(making->grid_bytes);
    size_t file_bytes = making->grid_bytes;
    unsigned char *at;

    made->grid = SEGMENT + METADATA + name_bytes;
    made->metadata = SEGMENT;
    made->bytes = at = xcalloc(1, made->grid + 4096 + packed_bytes);
    if (params->is_zip) {
        compress(at + made->grid + 8, &packed_bytes, making->grid, making->grid_bytes);
        put_u64(at + made->grid, packed_bytes);
        file_bytes = 8 + packed_bytes;
    } else if (params->is_blosc) {
        file_bytes = write_blosc(at + made->grid, making);
    } else {
        memcpy(at + made->grid, making->grid, making->grid_bytes);
    }
    put(at, "NanoVDB0", 8);
    put_u32(at + 8, 32U << 21 | 4U << 10 | 2U);
    put(at + 12, &(uint16_t){1}, 2);
    put(at + 14, &(uint16_t){params->is_zip ? 1 : params->is_blosc ? 2 : 0}, 2);
    put_u64(at + SEGMENT, making->grid_bytes);
    put_u64(at + SEGMENT + 8, file_bytes);
    put_u32(at + SEGMENT + 32, type_of(params));
    put_u32(at + SEGMENT + 36, 2);
    put_u32(at + SEGMENT + 136, (uint32_t)name_bytes);
    memcpy(at + SEGMENT + METADATA, params->name, name_bytes);
    made->size_bytes = made->grid + file_bytes;
}

// Lays out the parts of the grid one after another, and counts them.
static void lay_out(struct making *making, struct nanovdb_made *made)
{
    const struct nanovdb_params *params = making->params;
    size_t root_tiles = 0;

    each_leaf(making, count_leaf);
    for (size_t i = 0; i < params->tile_count; ++i)
        if (params->tiles[i].side == 4096)
            ++root_tiles;
        else if (params->tiles[i].side == 128)
            (void)upper_of(making, params->tiles[i].origin);
        else
            need_lower(making, params->tiles[i].origin);
    root_tiles += making->upper_count;
    made->leaf_count = making->leaf_count;
    made->tree = GRID;
    made->root = made->tree + TREE;
    made->root_tiles = made->root + ROOT;
    made->uppers = made->root_tiles + root_tiles * ROOT_TILE;
    made->lowers = made->uppers + making->upper_count * UPPER;
    made->leaves = made->lowers + making->lower_count * LOWER;
    made->lower_bytes = LOWER;
    made->upper_table = 8256;
    made->lower_table = 1088;
    made->leaf_values = 96;
    making->grid_bytes = made->leaves;
    for (size_t i = making->leaf_count; i > 0; --i) {
        making->leaf_count = i - 1;
        making->grid_bytes += 96 + 64 * (size_t)bits_of(making);
    }
    making->leaf_count = made->leaf_count;
    making->grid = xcalloc(1, making->grid_bytes);
    making->root = making->grid + made->root;
    making->uppers = making->grid + made->uppers;
    making->lowers = making->grid + made->lowers;
    making->leaves = making->grid + made->leaves;
}

void nanovdb_make(struct nanovdb_made *made, const struct nanovdb_params *params)
{
    struct making *making = xcalloc(1, sizeof *making);

    making->params = params;
    lay_out(making, made);
    fill_tables(making);
    for (size_t i = 0; i < making->upper_count; ++i)
        write_root_tile(making, making->places[i].voxel, (uint64_t)(making->uppers + i * UPPER - making->root), NULL);
    for (size_t i = 0; i < params->tile_count; ++i)
        write_tile(making, &params->tiles[i]);
    making->leaf_count = 0;
    each_leaf(making, write_leaf);
    write_grid(making);
    write_file(made, making);
    made->tree += made->grid;
    made->root += made->grid;
    made->root_tiles += made->grid;
    made->uppers += made->grid;
    made->lowers += made->grid;
    made->leaves += made->grid;
    free(making->grid);
    free(making);
}
