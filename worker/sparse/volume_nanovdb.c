// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/volume_nanovdb.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/sparse/nanovdb_leaf.h"
#include "worker/sparse/sparse_grid.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PNANOVDB_C
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <nanovdb/PNanoVDB.h>
#pragma GCC diagnostic pop

enum {
    FLOAT = PNANOVDB_GRID_TYPE_FLOAT,
    ROOT_TILE_LIMIT = 4096,
    ALIGNMENT = 32, // of every node
    COORDINATE_LIMIT = 1 << 29
};

static const uint64_t brick_limit = 1U << 24;
static const uint64_t magic_first = 0x304244566f6e614e, magic_grid = 0x314244566f6e614e;

// The nodes of one level: their position in the buffer, and which of them a parent has named.
struct level {
    const char *name;
    uint64_t begin, count, node_bytes; // each has at least so many bytes
    uint64_t step_bytes, step_count;   // nodes begin at multiples of a step: a node, or less where their sizes differ
    uint64_t used_count;
    unsigned char *is_used; // owned; by step
};

struct tile {
    int64_t origin[3];
    int64_t side; // voxels
    float value;
    bool is_active;
};

struct leaf {
    int64_t origin[3];
    uint64_t address;
};

struct tree {
    pnanovdb_buf_t buffer;
    const unsigned char *bytes; // the same
    uint64_t size_bytes;
    uint32_t type;
    pnanovdb_root_handle_t root;
    struct level uppers, lowers, leaves;
    float background;
    struct leaf *found_leaves; // owned
    size_t leaf_count;
    struct tile *tiles; // owned; those whose value is not the background
    size_t tile_count, tile_capacity;
    int64_t min[3], max[3]; // of active voxels
};

static float read_float(const struct tree *tree, pnanovdb_address_t address)
{
    return pnanovdb_read_float(tree->buffer, address);
}

static bool check_class(const struct tree *tree, pnanovdb_grid_handle_t grid, struct error *error)
{
    static const char *const names[] = {"unknown",     "level set",  "fog volume", "staggered",
                                        "point index", "point data", "topology",   "voxel volume"};
    uint32_t class = pnanovdb_grid_get_grid_class(tree->buffer, grid);

    if (class == PNANOVDB_GRID_CLASS_UNKNOWN || class == PNANOVDB_GRID_CLASS_FOG_VOLUME) return true;
    error_set(error, "expected a fog volume, got class %s",
              class < sizeof names / sizeof *names ? names[class] : "unknown");
    return false;
}

static bool check_grid(const struct tree *tree, pnanovdb_grid_handle_t grid, struct error *error)
{
    uint64_t magic = pnanovdb_grid_get_magic(tree->buffer, grid);
    uint32_t version = pnanovdb_grid_get_version(tree->buffer, grid);

    if (magic != magic_first && magic != magic_grid) {
        error_set(error, "the grid does not begin as a NanoVDB grid does");
        return false;
    }
    if (pnanovdb_version_get_major(version) != PNANOVDB_MAJOR_VERSION_NUMBER) {
        error_set(error, "version: expected %d, got %" PRIu32, PNANOVDB_MAJOR_VERSION_NUMBER,
                  pnanovdb_version_get_major(version));
        return false;
    }
    if (pnanovdb_grid_get_grid_type(tree->buffer, grid) != tree->type) {
        error_set(error, "the grid's own type is another than its entry says");
        return false;
    }
    if (pnanovdb_grid_get_grid_size(tree->buffer, grid) != tree->size_bytes) {
        error_set(error, "expected %zu bytes, the grid says %" PRIu64, (size_t)tree->size_bytes,
                  pnanovdb_grid_get_grid_size(tree->buffer, grid));
        return false;
    }
    return check_class(tree, grid, error);
}

static bool init_level(struct level *level, const struct tree *tree, uint64_t offset, struct error *error)
{
    uint64_t rest = tree->size_bytes - PNANOVDB_GRID_SIZE;

    level->begin = PNANOVDB_GRID_SIZE + offset;
    if (offset % ALIGNMENT != 0 || offset > rest || level->count > (rest - offset) / level->node_bytes) {
        error_set(error, "%" PRIu64 " %s nodes at byte %" PRIu64 " of the tree do not fit into %" PRIu64 " bytes",
                  level->count, level->name, offset, rest);
        return false;
    }
    if (level->step_bytes == 0) level->step_bytes = level->node_bytes;
    level->step_count = level->step_bytes == level->node_bytes ? level->count : (rest - offset) / level->step_bytes;
    level->is_used = xcalloc(level->step_count + 1, 1);
    return true;
}

static bool find_root(struct tree *tree, pnanovdb_tree_handle_t handle, struct error *error)
{
    uint64_t offset = pnanovdb_tree_get_node_offset_root(tree->buffer, handle);
    uint64_t rest = tree->size_bytes - PNANOVDB_GRID_SIZE;
    uint64_t root_bytes = PNANOVDB_GRID_TYPE_GET(FLOAT, root_size),
             tile_bytes = PNANOVDB_GRID_TYPE_GET(FLOAT, root_tile_size);
    uint64_t tile_count;

    if (offset % ALIGNMENT != 0 || offset > rest || root_bytes > rest - offset) {
        error_set(error, "the root at byte %" PRIu64 " of the tree lies outside of its %" PRIu64, offset, rest);
        return false;
    }
    tree->root = pnanovdb_tree_get_root(tree->buffer, handle);
    tile_count = pnanovdb_root_get_tile_count(tree->buffer, tree->root);
    if (tile_count > ROOT_TILE_LIMIT || tile_count * tile_bytes > rest - offset - root_bytes) {
        error_set(error, "the root's %" PRIu64 " tiles are more than %d or lie outside of the grid", tile_count,
                  (int)ROOT_TILE_LIMIT);
        return false;
    }
    tree->background = read_float(
        tree, pnanovdb_address_offset(tree->root.address, PNANOVDB_GRID_TYPE_GET(FLOAT, root_off_background)));
    if (!isfinite(tree->background)) {
        error_set(error, "the background is not finite");
        return false;
    }
    return true;
}

static bool open_tree(struct tree *tree, struct error *error)
{
    pnanovdb_grid_handle_t grid = {{0}};
    pnanovdb_tree_handle_t handle;

    if (tree->size_bytes < PNANOVDB_GRID_SIZE + PNANOVDB_TREE_SIZE || tree->size_bytes % ALIGNMENT != 0) {
        error_set(error, "%zu bytes are no grid", (size_t)tree->size_bytes);
        return false;
    }
    if (!check_grid(tree, grid, error)) return false;
    handle = pnanovdb_grid_get_tree(tree->buffer, grid);
    tree->uppers = (struct level){.name = "upper",
                                  .count = pnanovdb_tree_get_node_count_upper(tree->buffer, handle),
                                  .node_bytes = PNANOVDB_GRID_TYPE_GET(FLOAT, upper_size)};
    tree->lowers = (struct level){.name = "lower",
                                  .count = pnanovdb_tree_get_node_count_lower(tree->buffer, handle),
                                  .node_bytes = PNANOVDB_GRID_TYPE_GET(FLOAT, lower_size)};
    tree->leaves = (struct level){.name = "leaf",
                                  .count = pnanovdb_tree_get_node_count_leaf(tree->buffer, handle),
                                  .node_bytes = nanovdb_leaf_least_bytes(tree->type),
                                  .step_bytes = tree->type == NANOVDB_FPN ? ALIGNMENT : 0};
    return init_level(&tree->uppers, tree, pnanovdb_tree_get_node_offset_upper(tree->buffer, handle), error) &&
           init_level(&tree->lowers, tree, pnanovdb_tree_get_node_offset_lower(tree->buffer, handle), error) &&
           init_level(&tree->leaves, tree, pnanovdb_tree_get_node_offset_leaf(tree->buffer, handle), error) &&
           find_root(tree, handle, error);
}

// Checks that a child is a node of its level and has no other parent, so that the walk ends and counts each node once.
static bool claim_child(struct level *level, uint64_t parent, int64_t offset, uint64_t *address, struct error *error)
{
    uint64_t position = parent + (uint64_t)offset - level->begin; // wraps to a huge number when it is before them

    if (position % level->step_bytes != 0 || position / level->step_bytes >= level->step_count) {
        error_set(error, "a child at offset %" PRId64 " is no %s node", offset, level->name);
        return false;
    }
    if (level->is_used[position / level->step_bytes]++) {
        error_set(error, "two nodes share a %s node", level->name);
        return false;
    }
    if (level->used_count++ == level->count) {
        error_set(error, "expected %" PRIu64 " %s nodes, got more", level->count, level->name);
        return false;
    }
    *address = level->begin + position;
    return true;
}

static void grow_box(struct tree *tree, const int64_t origin[3], int64_t side)
{
    for (int axis = 0; axis < 3; ++axis) {
        if (origin[axis] < tree->min[axis]) tree->min[axis] = origin[axis];
        if (origin[axis] + side - 1 > tree->max[axis]) tree->max[axis] = origin[axis] + side - 1;
    }
}

static void add_tile(struct tree *tree, struct tile tile)
{
    if (tile.is_active) grow_box(tree, tile.origin, tile.side);
    if (tile.value == tree->background) return;
    tree->tiles = xgrow(tree->tiles, &tree->tile_capacity, tree->tile_count + 1, sizeof *tree->tiles);
    tree->tiles[tree->tile_count++] = tile;
}

// Checks that the leaf lies in the grid, with all its values.
static bool check_leaf(const struct tree *tree, uint64_t address, struct error *error)
{
    uint64_t rest = tree->size_bytes - address;

    if (nanovdb_leaf_least_bytes(tree->type) <= rest) {
        uint64_t leaf_bytes = nanovdb_leaf_bytes(tree->type, tree->bytes + address);

        if (leaf_bytes > 0 && leaf_bytes <= rest) return true;
    }
    error_set(error, "the leaf node at byte %" PRIu64 " names no number of bits, or lies outside of the grid", address);
    return false;
}

static void add_leaf(struct tree *tree, const int64_t origin[3], uint64_t address)
{
    pnanovdb_leaf_handle_t leaf = {{address}};
    struct leaf *found = &tree->found_leaves[tree->leaf_count++];

    *found = (struct leaf){.address = address};
    memcpy(found->origin, origin, sizeof found->origin);
    for (uint32_t n = 0; n < SPARSE_BRICK_VOXELS; ++n)
        if (pnanovdb_leaf_get_value_mask(tree->buffer, leaf, n)) {
            int64_t voxel[3] = {origin[0] + (n >> 6), origin[1] + (n >> 3 & 7), origin[2] + (n & 7)};

            grow_box(tree, voxel, 1);
        }
}

static bool walk_lower(struct tree *tree, const int64_t origin[3], uint64_t address, struct error *error)
{
    pnanovdb_lower_handle_t lower = {{address}};

    for (uint32_t n = 0; n < PNANOVDB_LOWER_TABLE_COUNT; ++n) {
        int64_t child_origin[3] = {origin[0] + (n >> 8) * 8, origin[1] + (n >> 4 & 15) * 8, origin[2] + (n & 15) * 8};
        uint64_t child;

        if (pnanovdb_lower_get_child_mask(tree->buffer, lower, n)) {
            if (!claim_child(&tree->leaves, address, pnanovdb_lower_get_table_child(FLOAT, tree->buffer, lower, n),
                             &child, error) ||
                !check_leaf(tree, child, error))
                return false;
            add_leaf(tree, child_origin, child);
        } else {
            add_tile(tree,
                     (struct tile){{child_origin[0], child_origin[1], child_origin[2]},
                                   8,
                                   read_float(tree, pnanovdb_lower_get_table_address(FLOAT, tree->buffer, lower, n)),
                                   pnanovdb_lower_get_value_mask(tree->buffer, lower, n)});
        }
    }
    return true;
}

static bool walk_upper(struct tree *tree, const int64_t origin[3], uint64_t address, struct error *error)
{
    pnanovdb_upper_handle_t upper = {{address}};

    for (uint32_t n = 0; n < PNANOVDB_UPPER_TABLE_COUNT; ++n) {
        int64_t child_origin[3] = {origin[0] + (n >> 10) * 128, origin[1] + (n >> 5 & 31) * 128,
                                   origin[2] + (n & 31) * 128};
        uint64_t child;

        if (pnanovdb_upper_get_child_mask(tree->buffer, upper, n)) {
            if (!claim_child(&tree->lowers, address, pnanovdb_upper_get_table_child(FLOAT, tree->buffer, upper, n),
                             &child, error) ||
                !walk_lower(tree, child_origin, child, error))
                return false;
        } else {
            add_tile(tree,
                     (struct tile){{child_origin[0], child_origin[1], child_origin[2]},
                                   128,
                                   read_float(tree, pnanovdb_upper_get_table_address(FLOAT, tree->buffer, upper, n)),
                                   pnanovdb_upper_get_value_mask(tree->buffer, upper, n)});
        }
    }
    return true;
}

// A root key has the upper 20 bits of each 32-bit coordinate, 21 bits apart, x highest.
static int64_t key_origin(uint64_t key, int shift)
{
    return (int32_t)((uint32_t)(key >> shift) << 12);
}

static bool walk_root_tile(struct tree *tree, uint32_t n, struct error *error)
{
    pnanovdb_root_tile_handle_t tile = pnanovdb_root_get_tile(FLOAT, tree->root, n);
    uint64_t key = pnanovdb_root_tile_get_key(tree->buffer, tile), child;
    int64_t origin[3] = {key_origin(key, 42), key_origin(key, 21), key_origin(key, 0)};
    int64_t offset = pnanovdb_root_tile_get_child(tree->buffer, tile);

    for (uint32_t i = 0; i < n; ++i)
        if (pnanovdb_root_tile_get_key(tree->buffer, pnanovdb_root_get_tile(FLOAT, tree->root, i)) == key) {
            error_set(error, "two of the root's tiles have one position");
            return false;
        }
    if (offset != 0)
        return claim_child(&tree->uppers, tree->root.address.byte_offset, offset, &child, error) &&
               walk_upper(tree, origin, child, error);
    add_tile(tree, (struct tile){{origin[0], origin[1], origin[2]},
                                 4096,
                                 read_float(tree, pnanovdb_root_tile_get_value_address(FLOAT, tree->buffer, tile)),
                                 pnanovdb_root_tile_get_state(tree->buffer, tile) != 0});
    return true;
}

static bool walk_tree(struct tree *tree, struct error *error)
{
    uint32_t count = pnanovdb_root_get_tile_count(tree->buffer, tree->root);

    tree->found_leaves = xcalloc(tree->leaves.count + 1, sizeof *tree->found_leaves);
    for (int axis = 0; axis < 3; ++axis) {
        tree->min[axis] = INT64_MAX;
        tree->max[axis] = INT64_MIN;
    }
    for (uint32_t n = 0; n < count; ++n)
        if (!walk_root_tile(tree, n, error)) return false;
    if (tree->min[0] > tree->max[0])
        for (int axis = 0; axis < 3; ++axis)
            tree->min[axis] = tree->max[axis] = 0; // nothing is active: one voxel stands for the background
    return true;
}

static bool place_lattice(struct sparse_grid *grid, const struct tree *tree, struct error *error)
{
    uint64_t total = 1;

    for (int axis = 0; axis < 3; ++axis) {
        int64_t first, last;

        if (tree->min[axis] < -COORDINATE_LIMIT || tree->max[axis] > COORDINATE_LIMIT) {
            error_set(error, "voxels lie beyond %d of the origin", (int)COORDINATE_LIMIT);
            return false;
        }
        first = (int64_t)floor((double)(tree->min[axis] - 1) / SPARSE_BRICK_SIDE);
        last = (int64_t)floor((double)(tree->max[axis] + 1) / SPARSE_BRICK_SIDE);
        grid->voxel_min[axis] = (int)tree->min[axis];
        grid->voxel_max[axis] = (int)tree->max[axis];
        grid->brick_min[axis] = (int)first;
        grid->brick_count[axis] = (int)(last - first + 1);
        if (grid->brick_count[axis] > SPARSE_LATTICE_LIMIT) {
            error_set(error, "active voxels %d to %d along axis %d; expected at most %d", grid->voxel_min[axis],
                      grid->voxel_max[axis], axis, SPARSE_LATTICE_LIMIT * SPARSE_BRICK_SIDE - 2);
            return false;
        }
        total *= (uint64_t)grid->brick_count[axis];
    }
    if (total > brick_limit) {
        error_set(error, "the active voxels span %" PRIu64 " bricks of 8^3; expected at most %" PRIu64, total,
                  brick_limit);
        return false;
    }
    return true;
}

static struct sparse_brick *brick_at(const struct sparse_grid *grid, int64_t i, int64_t j, int64_t k)
{
    return &grid->bricks[i + grid->brick_count[0] * (j + grid->brick_count[1] * k)];
}

static bool paint_tile(struct sparse_grid *grid, const struct tile *tile, struct error *error)
{
    int64_t begin[3], end[3];

    for (int axis = 0; axis < 3; ++axis) {
        begin[axis] = tile->origin[axis] / SPARSE_BRICK_SIDE - grid->brick_min[axis];
        end[axis] = begin[axis] + tile->side / SPARSE_BRICK_SIDE;
        if (begin[axis] < 0) begin[axis] = 0;
        if (end[axis] > grid->brick_count[axis]) end[axis] = grid->brick_count[axis];
        if (begin[axis] >= end[axis]) return true;
    }
    if (!isfinite(tile->value)) {
        error_set(error, "the tile at voxel (%" PRId64 ", %" PRId64 ", %" PRId64 ") is not finite", tile->origin[0],
                  tile->origin[1], tile->origin[2]);
        return false;
    }
    for (int64_t k = begin[2]; k < end[2]; ++k)
        for (int64_t j = begin[1]; j < end[1]; ++j)
            for (int64_t i = begin[0]; i < end[0]; ++i)
                brick_at(grid, i, j, k)->value = tile->value;
    return true;
}

static bool copy_leaf(struct sparse_grid *grid, const struct tree *tree, const struct leaf *leaf, struct error *error)
{
    float own[NANOVDB_LEAF_VOXELS], *values = grid->leaves + grid->leaf_count * SPARSE_BRICK_VOXELS;
    int64_t brick[3];

    for (int axis = 0; axis < 3; ++axis) {
        brick[axis] = leaf->origin[axis] / SPARSE_BRICK_SIDE - grid->brick_min[axis];
        // No voxel of the leaf is active, and it is outside of the lattice.
        if (brick[axis] < 0 || brick[axis] >= grid->brick_count[axis]) return true;
    }
    nanovdb_leaf_read(tree->type, tree->bytes + leaf->address, own);
    for (uint32_t n = 0; n < SPARSE_BRICK_VOXELS; ++n) {
        if (!isfinite(own[n])) {
            error_set(error, "voxel (%" PRId64 ", %" PRId64 ", %" PRId64 ") is not finite", leaf->origin[0] + (n >> 6),
                      leaf->origin[1] + (n >> 3 & 7), leaf->origin[2] + (n & 7));
            return false;
        }
        values[(n >> 6) + 8 * (n >> 3 & 7) + 64 * (n & 7)] = own[n];
    }
    brick_at(grid, brick[0], brick[1], brick[2])->leaf = (int32_t)grid->leaf_count++;
    return true;
}

static bool fill_bricks(struct sparse_grid *grid, const struct tree *tree, struct error *error)
{
    size_t total = sparse_grid_brick_total(grid);

    grid->background = tree->background;
    grid->bricks = malloc(total * sizeof *grid->bricks);
    grid->leaves = malloc((tree->leaf_count + 1) * SPARSE_BRICK_VOXELS * sizeof *grid->leaves);
    if (!grid->bricks || !grid->leaves) {
        error_set(error, "out of memory for %zu bricks and %zu leaves", total, tree->leaf_count);
        return false;
    }
    for (size_t i = 0; i < total; ++i)
        grid->bricks[i] = (struct sparse_brick){-1, tree->background};
    for (size_t i = 0; i < tree->tile_count; ++i)
        if (!paint_tile(grid, &tree->tiles[i], error)) return false;
    for (size_t i = 0; i < tree->leaf_count; ++i)
        if (!copy_leaf(grid, tree, &tree->found_leaves[i], error)) return false;
    return true;
}

static bool read_map(struct sparse_grid *grid, const struct tree *tree, struct error *error)
{
    pnanovdb_map_handle_t map = pnanovdb_grid_get_map(tree->buffer, (pnanovdb_grid_handle_t){{0}});
    double *m = grid->index_to_world, determinant;

    for (uint32_t row = 0; row < 3; ++row) {
        for (uint32_t column = 0; column < 3; ++column)
            m[4 * row + column] = pnanovdb_map_get_matd(tree->buffer, map, 3 * row + column);
        m[4 * row + 3] = pnanovdb_map_get_vecd(tree->buffer, map, row);
    }
    determinant =
        m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
    if (isfinite(determinant) && determinant != 0 && isfinite(m[3]) && isfinite(m[7]) && isfinite(m[11])) return true;
    error_set(error, "the map from voxels to the world cannot be turned round");
    return false;
}

struct sparse_grid *volume_nanovdb_decode(const struct nanovdb_bytes *file, const char *name, struct error *error)
{
    struct tree tree = {0};
    struct sparse_grid *grid = NULL;
    struct nanovdb_unpacked unpacked;
    void *bytes = nanovdb_file_unpack(file, name, &unpacked, error);
    bool ok = false;

    if (!bytes) return NULL;
    tree.bytes = bytes;
    tree.size_bytes = unpacked.size_bytes;
    tree.type = unpacked.type;
    tree.buffer = pnanovdb_make_buf(bytes, unpacked.size_bytes / 4);
    if (!open_tree(&tree, error) || !walk_tree(&tree, error)) goto out;
    grid = xcalloc(1, sizeof *grid);
    ok = read_map(grid, &tree, error) && place_lattice(grid, &tree, error) && fill_bricks(grid, &tree, error);
out:
    free(bytes);
    free(tree.uppers.is_used);
    free(tree.lowers.is_used);
    free(tree.leaves.is_used);
    free(tree.found_leaves);
    free(tree.tiles);
    if (ok) return grid;
    sparse_grid_destroy(grid);
    if (name) error_prefix(error, "grid \"%s\"", name);
    return NULL;
}
