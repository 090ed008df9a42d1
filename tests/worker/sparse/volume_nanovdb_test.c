// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/volume_nanovdb.h"

#include "core/base/error.h"
#include "tests/support/assert_near.h"
#include "tests/support/nanovdb_maker.h"
#include "worker/sparse/sparse_grid.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// Returns a different number for each voxel.
static float value_of(const int voxel[3])
{
    return (float)(1 + (voxel[0] + 64) + 128 * (voxel[1] + 64) + 16384 * (voxel[2] + 64));
}

// The box contains the origin, where division and remainder must not round towards zero, and no end of it is a leaf's.
static const struct nanovdb_params asymmetric = {.name = "density",
                                                 .map = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, -11, 12},
                                                 .min = {-11, -3, 5},
                                                 .max = {12, 9, 18},
                                                 .value = value_of,
                                                 .background = 0.25F};

static struct sparse_grid *decode(const struct nanovdb_made *made, const char *name, struct error *error)
{
    struct nanovdb_bytes file = {made->bytes, made->size_bytes};

    *error = (struct error){{0}};
    return volume_nanovdb_decode(&file, name, error);
}

static struct sparse_grid *decode_made(const struct nanovdb_params *params)
{
    struct nanovdb_made made;
    struct error error;
    struct sparse_grid *grid;

    nanovdb_make(&made, params);
    grid = decode(&made, NULL, &error);
    free(made.bytes);
    if (!grid) fail_msg("%s", error.message);
    return grid;
}

static float at(const struct sparse_grid *grid, int i, int j, int k)
{
    return sparse_grid_at(grid, (const int[]){i, j, k});
}

static void check_values(const struct sparse_grid *grid, const struct nanovdb_params *params)
{
    int voxel[3];

    for (voxel[2] = params->min[2] - 20; voxel[2] <= params->max[2] + 20; ++voxel[2])
        for (voxel[1] = params->min[1] - 20; voxel[1] <= params->max[1] + 20; ++voxel[1])
            for (voxel[0] = params->min[0] - 20; voxel[0] <= params->max[0] + 20; ++voxel[0]) {
                float wanted = params->background;
                bool is_inside = true;

                for (int axis = 0; axis < 3; ++axis)
                    is_inside = is_inside && voxel[axis] >= params->min[axis] && voxel[axis] <= params->max[axis];
                if (is_inside) wanted = params->value(voxel);
                if (sparse_grid_at(grid, voxel) != wanted)
                    fail_msg("voxel (%d, %d, %d): %g, expected %g", voxel[0], voxel[1], voxel[2],
                             (double)sparse_grid_at(grid, voxel), (double)wanted);
            }
}

static void every_voxel_is_where_the_file_has_it(void **state)
{
    struct sparse_grid *grid = decode_made(&asymmetric);

    for (int axis = 0; axis < 3; ++axis) {
        assert_int_equal(grid->voxel_min[axis], asymmetric.min[axis]);
        assert_int_equal(grid->voxel_max[axis], asymmetric.max[axis]);
    }
    check_values(grid, &asymmetric);
    sparse_grid_destroy(grid);
}

static void the_lattice_covers_one_voxel_more_than_is_active(void **state)
{
    static const int brick_min[] = {-2, -1, 0}, brick_count[] = {4, 2, 2};
    struct nanovdb_params params = asymmetric;
    struct sparse_grid *grid;

    memcpy(params.min, (int[]){-8, 0, 1}, sizeof params.min);
    memcpy(params.max, (int[]){7, 6, 8}, sizeof params.max);
    grid = decode_made(&params);
    for (int axis = 0; axis < 3; ++axis) {
        assert_int_equal(grid->brick_min[axis], brick_min[axis]);
        assert_int_equal(grid->brick_count[axis], brick_count[axis]);
    }
    sparse_grid_destroy(grid);
}

static void zipped_is_the_same(void **state)
{
    struct nanovdb_params params = asymmetric;
    struct sparse_grid *grid;

    params.is_zip = true;
    grid = decode_made(&params);
    check_values(grid, &params);
    sparse_grid_destroy(grid);
}

static void the_map_is_read_by_rows(void **state)
{
    struct sparse_grid *grid = decode_made(&asymmetric);

    for (int i = 0; i < 12; ++i)
        assert_near(grid->index_to_world[i], asymmetric.map[i], 0);
    sparse_grid_destroy(grid);
}

static void tiles_of_every_size_have_their_value(void **state)
{
    static const struct nanovdb_tile tiles[] = {
        {{16, 8, -8}, 8, 3, true}, {{-128, 0, 0}, 128, 5, false}, {{-4096, -4096, 0}, 4096, 7, false}};
    struct nanovdb_params params = asymmetric;
    struct sparse_grid *grid;

    memcpy(params.min, (int[]){1, 1, 1}, sizeof params.min);
    memcpy(params.max, (int[]){2, 2, 2}, sizeof params.max);
    params.tiles = tiles;
    params.tile_count = 1;
    grid = decode_made(&params);
    assert_int_equal(grid->voxel_max[0], 23);
    assert_int_equal(grid->voxel_min[2], -8);
    assert_true(at(grid, 16, 8, -8) == 3 && at(grid, 23, 15, -1) == 3);
    assert_true(at(grid, 15, 8, -8) == 0.25F && at(grid, 16, 8, 0) == 0.25F);
    sparse_grid_destroy(grid);

    // Inactive tiles do not widen the box; their part inside the lattice counts.
    memcpy(params.min, (int[]){-4090, 0, 0}, sizeof params.min);
    memcpy(params.max, (int[]){-4090, 0, 0}, sizeof params.max);
    params.tiles = &(struct nanovdb_tile){{-3968, 0, 0}, 128, 5, false};
    grid = decode_made(&params);
    assert_int_equal(grid->voxel_max[0], -4090);
    assert_true(at(grid, -4090, 1, 0) == 0.25F);
    sparse_grid_destroy(grid);
    params.tiles = tiles + 1;
    memcpy(params.min, (int[]){-1000, 0, 0}, sizeof params.min);
    memcpy(params.max, (int[]){-129, 0, 0}, sizeof params.max);
    grid = decode_made(&params);
    assert_true(at(grid, -128, 0, 0) == 5 && at(grid, -121, 7, 7) == 5);
    assert_true(at(grid, -128, -1, 0) == 0.25F);
    sparse_grid_destroy(grid);
    params.tiles = tiles + 2;
    memcpy(params.min, (int[]){0, 0, 0}, sizeof params.min);
    memcpy(params.max, (int[]){0, 0, 0}, sizeof params.max);
    grid = decode_made(&params);
    assert_true(at(grid, -1, -1, 0) == 7 && at(grid, -1, 0, 0) == 0.25F);
    sparse_grid_destroy(grid);
}

static void a_grid_without_active_voxels_is_one_of_background(void **state)
{
    struct nanovdb_params params = asymmetric;
    struct sparse_grid *grid;

    params.min[0] = 1, params.max[0] = 0;
    grid = decode_made(&params);
    assert_true(at(grid, 0, 0, 0) == 0.25F && grid->leaf_count == 0);
    assert_int_equal(grid->voxel_min[0], grid->voxel_max[0]);
    sparse_grid_destroy(grid);
}

// Concatenated files are a file of all their grids.
static struct nanovdb_made join(const struct nanovdb_params *a, const struct nanovdb_params *b)
{
    struct nanovdb_made first, second;

    nanovdb_make(&first, a);
    nanovdb_make(&second, b);
    first.bytes = realloc(first.bytes, first.size_bytes + second.size_bytes);
    memcpy(first.bytes + first.size_bytes, second.bytes, second.size_bytes);
    first.size_bytes += second.size_bytes;
    free(second.bytes);
    return first;
}

static void a_grid_is_found_by_name(void **state)
{
    struct nanovdb_params hot = asymmetric;
    struct nanovdb_made made;
    struct error error;
    struct sparse_grid *grid;

    hot.name = "temperature";
    hot.background = 9;
    made = join(&asymmetric, &hot);
    grid = decode(&made, "temperature", &error);
    assert_true(grid && grid->background == 9);
    sparse_grid_destroy(grid);
    made.bytes[made.metadata + 32] = 6; // a vec3f grid first: the default is the first of floats
    grid = decode(&made, NULL, &error);
    assert_true(grid && grid->background == 9);
    sparse_grid_destroy(grid);
    assert_null(decode(&made, "density", &error));
    assert_string_equal(error.message, "grid \"density\": expected float values, got vec3f");
    assert_null(decode(&made, "heat", &error));
    assert_string_equal(error.message,
                        "no grid is named \"heat\"; there are \"density\" (vec3f), \"temperature\" (float)");
    free(made.bytes);
}

struct damage {
    const char *what;
    size_t place;
    const void *bytes;
    size_t size_bytes;
    const char *message;
};

#define BYTES(type, value) (const type[]){value}, sizeof(type)

static void check_damage(const struct nanovdb_made *made, const struct damage *damage)
{
    struct nanovdb_made damaged = *made;
    struct error error;
    struct sparse_grid *grid;

    damaged.bytes = malloc(made->size_bytes);
    memcpy(damaged.bytes, made->bytes, made->size_bytes);
    memcpy(damaged.bytes + damage->place, damage->bytes, damage->size_bytes);
    grid = decode(&damaged, NULL, &error);
    free(damaged.bytes);
    if (grid || !strstr(error.message, damage->message))
        fail_msg("%s: got \"%s\", expected \"%s\"", damage->what, grid ? "a grid" : error.message, damage->message);
}

static void damaged_files_are_refused_by_what_is_wrong(void **state)
{
    struct nanovdb_made m;
    size_t lower_entry, other_entry;

    nanovdb_make(&m, &asymmetric);
    lower_entry = m.lowers + m.lower_table + 8 * (size_t)(14 << 8 | 15 << 4 | 0); // of the first leaf, at (-16, -8, 0)
    other_entry = lower_entry + 8;
    {
        const struct damage damages[] = {
            {"magic", 0, BYTES(char, 'X'), "expected a NanoVDB file"},
            {"version", 8, BYTES(uint32_t, 33U << 21), "version: expected NanoVDB 32, got 33"},
            {"codec", 14, BYTES(uint16_t, 7), "codec: expected none, zip or Blosc, got number 7"},
            {"blosc", 14, BYTES(uint16_t, 2), "Blosc: the packed grid is damaged"},
            {"zip", 14, BYTES(uint16_t, 1), "zip: the packed size differs"},
            {"name", m.metadata + 136, BYTES(uint32_t, 0), "grid name: expected 1 to"},
            {"name end", m.grid - 1, BYTES(char, 'x'), "expected to end in NUL"},
            {"type", m.metadata + 32, BYTES(uint32_t, 6), "expected a grid of floats; there are \"density\" (vec3f)"},
            {"memory", m.metadata, BYTES(uint64_t, 1), "sizes in the file and in memory differ"},
            {"bytes", m.metadata + 8, BYTES(uint64_t, UINT64_MAX), "the file is cut short"},
            {"grid magic", m.grid, BYTES(char, 'X'), "does not begin as a NanoVDB grid"},
            {"grid version", m.grid + 16, BYTES(uint32_t, 31U << 21), "version: expected 32, got 31"},
            {"grid type", m.grid + 636, BYTES(uint32_t, 2), "own type is another"},
            {"grid size", m.grid + 32, BYTES(uint64_t, 64), "the grid says 64"},
            {"class", m.grid + 632, BYTES(uint32_t, 1), "expected a fog volume, got class level set"},
            {"map", m.grid + 296 + 88, BYTES(double, NAN), "the map from voxels to the world"},
            {"leaf offset", m.tree, BYTES(uint64_t, 33), "leaf nodes at byte 33"},
            {"far leaf", m.tree, BYTES(uint64_t, UINT64_MAX - 31), "leaf nodes at byte"},
            {"leaf count", m.tree + 32, BYTES(uint32_t, UINT32_MAX), "leaf nodes at byte"},
            {"lower count", m.tree + 36, BYTES(uint32_t, UINT32_MAX), "lower nodes at byte"},
            {"upper count", m.tree + 40, BYTES(uint32_t, 99), "upper nodes at byte"},
            {"root", m.tree + 24, BYTES(uint64_t, UINT64_MAX - 31), "the root at byte"},
            {"root tiles", m.root + 24, BYTES(uint32_t, UINT32_MAX), "the root's 4294967295 tiles"},
            {"root child", m.root_tiles + 8, BYTES(int64_t, -64), "is no upper node"},
            {"upper child", m.uppers + m.upper_table + 8 * (size_t)(31 << 10 | 31 << 5), BYTES(int64_t, 96),
             "is no lower node"},
            {"lower child", lower_entry, BYTES(int64_t, INT64_MIN), "is no leaf node"},
            {"background", m.root + 28, BYTES(float, NAN), "the background is not finite"},
            {"voxel", m.leaves + m.leaf_values + 4, BYTES(float, NAN), "voxel (-16, -8, 1) is not finite"},
            {"voxel", m.leaves + m.leaf_values, BYTES(float, INFINITY), "voxel (-16, -8, 0) is not finite"},
        };

        for (size_t i = 0; i < sizeof damages / sizeof *damages; ++i)
            check_damage(&m, &damages[i]);
    }
    {
        uint64_t entry;

        memcpy(&entry, m.bytes + lower_entry, sizeof entry);
        check_damage(&m, &(struct damage){"shared", other_entry, &entry, sizeof entry, "two nodes share a leaf node"});
    }
    free(m.bytes);
}

static void two_root_tiles_of_one_place_are_refused(void **state)
{
    static const struct nanovdb_tile far_away = {{4096, 0, 0}, 4096, 1, false};
    struct nanovdb_params params = asymmetric;
    struct nanovdb_made made;
    uint64_t key;

    params.tiles = &far_away;
    params.tile_count = 1;
    nanovdb_make(&made, &params);
    memcpy(&key, made.bytes + made.root_tiles, sizeof key);
    check_damage(&made, &(struct damage){"twice", made.root_tiles + 32, &key, sizeof key, "tiles have one position"});
    free(made.bytes);
}

static void a_tile_that_is_not_finite_is_refused_only_where_it_counts(void **state)
{
    static const struct nanovdb_tile near_by = {{16, 8, 8}, 8, NAN, true}, far_away = {{128, 0, 0}, 128, NAN, false};
    struct nanovdb_params params = asymmetric;
    struct nanovdb_made made;
    struct error error;

    params.tiles = &near_by;
    params.tile_count = 1;
    nanovdb_make(&made, &params);
    assert_null(decode(&made, NULL, &error));
    assert_string_equal(error.message, "the tile at voxel (16, 8, 8) is not finite");
    free(made.bytes);
    params.tiles = &far_away;
    sparse_grid_destroy(decode_made(&params));
}

static void extents_beyond_a_texture_are_refused(void **state)
{
    static const struct nanovdb_tile far_away = {{1 << 20, 0, 0}, 4096, 1, true},
                                     wide = {{4096, 4096, 4096}, 4096, 1, true},
                                     farther = {{-2147483647 - 1, 0, 0}, 4096, 1, true};
    struct nanovdb_params params = asymmetric;
    struct nanovdb_made made;
    struct error error;

    params.tile_count = 1;
    params.tiles = &far_away;
    nanovdb_make(&made, &params);
    assert_null(decode(&made, NULL, &error));
    assert_string_equal(error.message, "active voxels -11 to 1052671 along axis 0; expected at most 16382");
    free(made.bytes);
    params.tiles = &wide;
    nanovdb_make(&made, &params);
    assert_null(decode(&made, NULL, &error));
    assert_non_null(strstr(error.message, "bricks of 8^3; expected at most 16777216"));
    free(made.bytes);
    params.tiles = &farther;
    nanovdb_make(&made, &params);
    assert_null(decode(&made, NULL, &error));
    assert_non_null(strstr(error.message, "voxels lie beyond"));
    free(made.bytes);
}

static void a_file_cut_anywhere_is_refused(void **state)
{
    struct nanovdb_params params = asymmetric;

    for (int zip = 0; zip < 2; ++zip) {
        struct nanovdb_made made;
        struct error error;

        params.is_zip = zip;
        nanovdb_make(&made, &params);
        for (size_t cut = 0; cut < made.size_bytes; cut += cut < 256 ? 1 : 4099) {
            struct nanovdb_made part = made;

            part.bytes = malloc(cut + 1); // separate memory, so that a read past the end is found
            memcpy(part.bytes, made.bytes, cut);
            part.size_bytes = cut;
            assert_null(decode(&part, NULL, &error));
            assert_non_null(strstr(error.message, "cut short"));
            free(part.bytes);
        }
        free(made.bytes);
    }
}

static void a_damaged_zip_is_refused(void **state)
{
    struct nanovdb_params params = asymmetric;
    struct nanovdb_made made;
    struct error error;

    params.is_zip = true;
    nanovdb_make(&made, &params);
    made.bytes[made.grid + 5000] ^= 0x55;
    made.bytes[made.grid + 5001] ^= 0x55;
    assert_null(decode(&made, NULL, &error));
    assert_non_null(strstr(error.message, "zip: the packed grid is damaged"));
    memcpy(made.bytes + made.metadata, &(uint64_t){UINT64_MAX}, 8);
    assert_null(decode(&made, NULL, &error));
    assert_non_null(strstr(error.message, "cannot unpack to"));
    free(made.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_voxel_is_where_the_file_has_it),
        cmocka_unit_test(the_lattice_covers_one_voxel_more_than_is_active),
        cmocka_unit_test(zipped_is_the_same),
        cmocka_unit_test(the_map_is_read_by_rows),
        cmocka_unit_test(tiles_of_every_size_have_their_value),
        cmocka_unit_test(a_grid_without_active_voxels_is_one_of_background),
        cmocka_unit_test(a_grid_is_found_by_name),
        cmocka_unit_test(damaged_files_are_refused_by_what_is_wrong),
        cmocka_unit_test(two_root_tiles_of_one_place_are_refused),
        cmocka_unit_test(a_tile_that_is_not_finite_is_refused_only_where_it_counts),
        cmocka_unit_test(extents_beyond_a_texture_are_refused),
        cmocka_unit_test(a_file_cut_anywhere_is_refused),
        cmocka_unit_test(a_damaged_zip_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
