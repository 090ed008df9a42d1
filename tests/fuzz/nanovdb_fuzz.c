// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "tests/support/nanovdb_maker.h"
#include "worker/sparse/brick_atlas.h"
#include "worker/sparse/sparse_grid.h"
#include "worker/sparse/volume_nanovdb.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { PATCH_BYTES = 12 };

static float value_of(const int voxel[3])
{
    return (float)voxel[0];
}

static const struct nanovdb_made *made_file(void)
{
    static const struct nanovdb_tile tiles[] = {
        {{16, 0, 0}, 8, 2, true}, {{256, 0, 0}, 128, 3, false}, {{4096, 0, 0}, 4096, 4, false}};
    static struct nanovdb_made made;

    if (!made.bytes)
        nanovdb_make(&made, &(struct nanovdb_params){.name = "density",
                                                     .map = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                                     .min = {3, 0, 0},
                                                     .max = {12, 7, 9},
                                                     .value = value_of,
                                                     .tiles = tiles,
                                                     .tile_count = 3});
    return &made;
}

// A grid that is read has a value for every voxel, and those of its bricks are finite.
static void decode(const void *bytes, size_t size)
{
    struct nanovdb_bytes file = {bytes, size};
    struct error error = {{0}};
    struct sparse_grid *grid = volume_nanovdb_decode(&file, NULL, &error);

    if (!grid) {
        if (!error.message[0]) abort();
        return;
    }
    for (size_t i = 0; i < sparse_grid_brick_total(grid) && i < 65536; ++i) // more would be slow
        if (grid->bricks[i].leaf >= (int32_t)grid->leaf_count ||
            !(grid->bricks[i].value - grid->bricks[i].value == 0.0F))
            abort();
    for (size_t i = 0; i < grid->leaf_count * SPARSE_BRICK_VOXELS; ++i)
        if (!(grid->leaves[i] - grid->leaves[i] == 0.0F)) abort();
    (void)sparse_grid_at(grid, grid->voxel_min);
    (void)sparse_grid_at(grid, (int[]){grid->voxel_max[0] + 1, grid->voxel_max[1] + 1, grid->voxel_max[2] + 1});
    if (sparse_grid_brick_total(grid) < 65536) {
        struct brick_atlas *atlas = brick_atlas_create(
            &(struct brick_atlas_params){.density = grid, .glow = grid, .memory_bytes = 1 << 28}, &error);

        if (!atlas && !error.message[0]) abort();
        brick_atlas_destroy(atlas);
    }
    sparse_grid_destroy(grid);
}

// A whole grid is too large to be found by chance, so the input is a list of patches to one. A patch is a byte for the
// piece, one for the number of bytes (1 to 8), two for the position in the piece, then the bytes.
static void decode_patched(const uint8_t *patches, size_t size)
{
    const struct nanovdb_made *made = made_file();
    const size_t pieces[] = {made->metadata,
                             made->grid,
                             made->grid + 632,
                             made->tree,
                             made->root,
                             made->root_tiles,
                             made->uppers,
                             made->uppers + made->upper_table,
                             made->uppers + 4128,
                             made->lowers,
                             made->lowers + made->lower_table,
                             made->lowers + 544,
                             made->leaves,
                             0};
    unsigned char *bytes = malloc(made->size_bytes);

    memcpy(bytes, made->bytes, made->size_bytes);
    for (; size >= PATCH_BYTES; patches += PATCH_BYTES, size -= PATCH_BYTES) {
        size_t at = pieces[patches[0] % (sizeof pieces / sizeof *pieces)] + patches[2] + 256 * (size_t)patches[3];
        size_t count = patches[1] % 8 + 1U;

        if (at + count <= made->size_bytes) memcpy(bytes + at, patches + 4, count);
    }
    decode(bytes, made->size_bytes);
    free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    if (size > 0 && bytes[0] == 'p')
        decode_patched(bytes + 1, size - 1);
    else
        decode(bytes, size);
    return 0;
}
