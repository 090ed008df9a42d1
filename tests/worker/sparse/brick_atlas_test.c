// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/brick_atlas.h"

#include "core/base/error.h"
#include "tests/support/assert_near.h"
#include "tests/support/nanovdb_maker.h"
#include "tests/support/random.h"
#include "worker/sparse/sparse_grid.h"
#include "worker/sparse/volume_nanovdb.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// Two clumps far apart, each across a corner where bricks meet.
static float clumps(const int voxel[3])
{
    int near = abs(voxel[0]) + abs(voxel[1] - 8) + abs(voxel[2]);
    int far = abs(voxel[0] - 56) + abs(voxel[1] - 40) + abs(voxel[2] - 24);

    return near < 6 ? (float)(7 - near) : far < 4 ? (float)(10 + far) : 0.0F;
}

static float heat(const int voxel[3])
{
    return (float)(voxel[0] + 100 * voxel[1]);
}

static const struct nanovdb_params scattered = {.name = "density",
                                                .map = {0.5, 0, 0, 1, 0, 0.5, 0, 2, 0, 0, 0.5, 3},
                                                .min = {-6, 2, -6},
                                                .max = {60, 44, 28},
                                                .value = clumps};

static struct sparse_grid *make_grid(const struct nanovdb_params *params)
{
    struct nanovdb_made made;
    struct error error = {{0}};
    struct sparse_grid *grid;

    nanovdb_make(&made, params);
    grid = volume_nanovdb_decode(&(struct nanovdb_bytes){made.bytes, made.size_bytes}, NULL, &error);
    free(made.bytes);
    if (!grid) fail_msg("%s", error.message);
    return grid;
}

static struct brick_atlas *make_atlas(const struct sparse_grid *density, const struct sparse_grid *glow)
{
    struct error error = {{0}};
    struct brick_atlas *atlas =
        brick_atlas_create(&(struct brick_atlas_params){.density = density, .glow = glow}, &error);

    if (!atlas) fail_msg("%s", error.message);
    return atlas;
}

// Returns the atlas's value of a voxel at an offset (0 or 1 per axis) from another in the same cell.
static float look_up(const struct brick_atlas *atlas, int which, const int voxel[3], const int offset[3])
{
    size_t index = 0, texel = 0;

    for (int axis = 2; axis >= 0; --axis)
        index = index * (size_t)atlas->brick_count[axis] +
                (size_t)(voxel[axis] - SPARSE_BRICK_SIDE * atlas->brick_min[axis]) / SPARSE_BRICK_SIDE;
    if (atlas->index[index][3] > 0) return 0;
    for (int axis = 2; axis >= 0; --axis)
        texel = texel * (size_t)atlas->texels[axis] + (size_t)(BRICK_ATLAS_SIDE * atlas->index[index][axis] +
                                                               (voxel[axis] & (SPARSE_BRICK_SIDE - 1)) + offset[axis]);
    return atlas->values[which][texel];
}

static void every_cell_has_its_eight_voxels(void **state)
{
    struct sparse_grid *density = make_grid(&scattered);
    struct brick_atlas *atlas = make_atlas(density, NULL);
    int voxel[3];

    for (voxel[2] = scattered.min[2] - 1; voxel[2] <= scattered.max[2]; ++voxel[2])
        for (voxel[1] = scattered.min[1] - 1; voxel[1] <= scattered.max[1]; ++voxel[1])
            for (voxel[0] = scattered.min[0] - 1; voxel[0] <= scattered.max[0]; ++voxel[0])
                for (int n = 0; n < 8; ++n) {
                    int offset[3] = {n & 1, n >> 1 & 1, n >> 2};
                    int at[3] = {voxel[0] + offset[0], voxel[1] + offset[1], voxel[2] + offset[2]};

                    if (look_up(atlas, 0, voxel, offset) != sparse_grid_at(density, at))
                        fail_msg("voxel (%d, %d, %d), corner %d", voxel[0], voxel[1], voxel[2], n);
                }
    brick_atlas_destroy(atlas);
    sparse_grid_destroy(density);
}

static void what_glows_is_there_where_density_is(void **state)
{
    struct nanovdb_params hot = scattered;
    struct sparse_grid *density = make_grid(&scattered), *glow;
    struct brick_atlas *atlas;
    int voxel[3] = {0, 8, 0};

    hot.value = heat;
    glow = make_grid(&hot);
    atlas = make_atlas(density, glow);
    for (voxel[0] = -5; voxel[0] <= 5; ++voxel[0])
        assert_near((double)look_up(atlas, 1, voxel, (int[]){1, 0, 0}), voxel[0] + 1 + 800, 0);
    brick_atlas_destroy(atlas);
    sparse_grid_destroy(glow);
    hot.map[3] += 0.25;
    glow = make_grid(&hot);
    {
        struct error error = {{0}};

        assert_null(brick_atlas_create(&(struct brick_atlas_params){.density = density, .glow = glow}, &error));
        assert_string_equal(error.message,
                            "the two grids' voxels lie in different positions; expected one map for both");
    }
    sparse_grid_destroy(glow);
    sparse_grid_destroy(density);
}

// Checks that no brick within the stored distance has density, nor any voxel that interpolation there uses.
static void no_density_lies_within_reach(void **state)
{
    struct sparse_grid *density = make_grid(&scattered);
    struct brick_atlas *atlas = make_atlas(density, NULL);
    const int *count = atlas->brick_count;
    size_t n = 0, far = 0;

    for (int k = 0; k < count[2]; ++k)
        for (int j = 0; j < count[1]; ++j)
            for (int i = 0; i < count[0]; ++i, ++n) {
                int reach = atlas->index[n][3], first[3], last[3], voxel[3], brick[3] = {i, j, k};

                far += reach > 1;
                if (reach == 0) continue;
                for (int axis = 0; axis < 3; ++axis) {
                    first[axis] = SPARSE_BRICK_SIDE * (atlas->brick_min[axis] + brick[axis] - reach + 1);
                    last[axis] = SPARSE_BRICK_SIDE * (atlas->brick_min[axis] + brick[axis] + reach);
                }
                for (voxel[2] = first[2]; voxel[2] <= last[2]; ++voxel[2])
                    for (voxel[1] = first[1]; voxel[1] <= last[1]; ++voxel[1])
                        for (voxel[0] = first[0]; voxel[0] <= last[0]; ++voxel[0])
                            assert_true(sparse_grid_at(density, voxel) == 0);
            }
    assert_true(far > 10);
    brick_atlas_destroy(atlas);
    sparse_grid_destroy(density);
}

// A texture's size depends on how many bricks have density, not on the size of the box.
static void bricks_without_density_take_no_room(void **state)
{
    struct sparse_grid *density = make_grid(&scattered);
    struct brick_atlas *atlas = make_atlas(density, NULL);
    size_t with_density = 0, slots = (size_t)atlas->slots[0] * (size_t)atlas->slots[1] * (size_t)atlas->slots[2];

    for (size_t n = 0; n < sparse_grid_brick_total(density); ++n)
        with_density += atlas->index[n][3] == 0;
    assert_true(with_density >= 16 && with_density < sparse_grid_brick_total(density) / 8);
    // All empty bricks share one slot; less than a layer of slots completes the box.
    assert_true(slots >= with_density + 1 && slots < with_density + 1 + 9);
    brick_atlas_destroy(atlas);
    sparse_grid_destroy(density);
}

static void bricks_that_do_not_fit_into_memory_are_refused(void **state)
{
    struct sparse_grid *density = make_grid(&scattered);
    struct error error = {{0}};

    assert_null(brick_atlas_create(&(struct brick_atlas_params){.density = density, .memory_bytes = 10000}, &error));
    assert_non_null(strstr(error.message, "are available"));
    sparse_grid_destroy(density);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_cell_has_its_eight_voxels),
        cmocka_unit_test(what_glows_is_there_where_density_is),
        cmocka_unit_test(no_density_lies_within_reach),
        cmocka_unit_test(bricks_without_density_take_no_room),
        cmocka_unit_test(bricks_that_do_not_fit_into_memory_are_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
