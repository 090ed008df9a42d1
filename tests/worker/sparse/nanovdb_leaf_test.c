// Quantised values and Blosc, in files that are made here, and as their bytes are documented.
// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/nanovdb_leaf.h"

#include "core/base/error.h"
#include "tests/support/nanovdb_maker.h"
#include "worker/sparse/sparse_grid.h"
#include "worker/sparse/volume_nanovdb.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// Between 0 and 1, and different in neighbours.
static float value_of(const int voxel[3])
{
    return (float)(0.5 + 0.5 * sin(voxel[0] + 2.3 * voxel[1] + 3.7 * voxel[2]));
}

// Six leaves, of which one is half empty.
static const struct nanovdb_params six = {.name = "density",
                                          .map = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                          .min = {-8, 0, 0},
                                          .max = {11, 15, 7},
                                          .value = value_of};

static struct sparse_grid *decode(const struct nanovdb_made *made, struct error *error)
{
    *error = (struct error){{0}};
    return volume_nanovdb_decode(&(struct nanovdb_bytes){made->bytes, made->size_bytes}, NULL, error);
}

// `limit`: the largest difference that quantising may make.
static void assert_values(const struct nanovdb_params *params, double limit)
{
    struct nanovdb_made made;
    struct error error;
    struct sparse_grid *grid;
    int voxel[3];

    nanovdb_make(&made, params);
    grid = decode(&made, &error);
    if (!grid) fail_msg("%s", error.message);
    for (voxel[0] = params->min[0]; voxel[0] <= params->max[0]; ++voxel[0])
        for (voxel[1] = params->min[1]; voxel[1] <= params->max[1]; ++voxel[1])
            for (voxel[2] = params->min[2]; voxel[2] <= params->max[2]; ++voxel[2])
                if (fabs((double)(sparse_grid_at(grid, voxel) - value_of(voxel))) > limit)
                    fail_msg("voxel (%d, %d, %d): %g", voxel[0], voxel[1], voxel[2],
                             (double)sparse_grid_at(grid, voxel));
    sparse_grid_destroy(grid);
    free(made.bytes);
}

// Half a quantum of a leaf whose values span at most 1, and rounding to floats.
static void quantised_values_are_half_a_quantum_off_at_most(void **state)
{
    struct nanovdb_params params = six;

    for (params.bits = 4; params.bits <= 16; params.bits *= 2)
        assert_values(&params, 0.5 / ((1 << params.bits) - 1) + 1e-6);
    params.bits = NANOVDB_MAKER_VARIABLE;
    assert_values(&params, 0.5 + 1e-6); // a leaf of one bit has but two values
}

static void blosc_unpacks_to_the_same(void **state)
{
    struct nanovdb_params params = six;

    params.is_blosc = true;
    assert_values(&params, 0);
    params.bits = 16;
    assert_values(&params, 0.5 / 65535 + 1e-6);
}

static void codes_lie_from_the_lowest_bit_on(void **state)
{
    unsigned char leaf[96 + 1024] = {0};
    const float minimum = 10, quantum = 0.5F;
    float values[NANOVDB_LEAF_VOXELS];

    memcpy(leaf + 80, &minimum, 4);
    memcpy(leaf + 84, &quantum, 4);
    leaf[96] = 0x21;
    leaf[97] = 0x43;
    nanovdb_leaf_read(NANOVDB_FP4, leaf, values);
    assert_true(values[0] == 10.5F && values[1] == 11 && values[2] == 11.5F && values[3] == 12 && values[4] == 10);
    nanovdb_leaf_read(NANOVDB_FP8, leaf, values);
    assert_true(values[0] == 10 + 0x21 * 0.5F && values[1] == 10 + 0x43 * 0.5F);
    nanovdb_leaf_read(NANOVDB_FP16, leaf, values);
    assert_true(values[0] == 10 + 0x4321 * 0.5F && values[1] == 10);
    leaf[15] = 0; // one bit
    nanovdb_leaf_read(NANOVDB_FPN, leaf, values);
    assert_true(values[0] == 10.5F && values[1] == 10 && values[5] == 10.5F && values[8] == 10.5F);
    leaf[15] = 1 << 5; // two
    nanovdb_leaf_read(NANOVDB_FPN, leaf, values);
    assert_true(values[0] == 10.5F && values[2] == 11 && values[4] == 11.5F);
}

static void leaves_take_what_their_bits_need(void **state)
{
    unsigned char leaf[96] = {0};

    assert_int_equal(nanovdb_leaf_least_bytes(NANOVDB_FLOAT), 2144);
    assert_int_equal(nanovdb_leaf_least_bytes(NANOVDB_FP4), 352);
    assert_int_equal(nanovdb_leaf_least_bytes(NANOVDB_FP8), 608);
    assert_int_equal(nanovdb_leaf_least_bytes(NANOVDB_FP16), 1120);
    assert_int_equal(nanovdb_leaf_bytes(NANOVDB_FP8, leaf), 608);
    for (unsigned log = 0; log < 8; ++log) {
        leaf[15] = (unsigned char)(log << 5 | 7);
        assert_int_equal(nanovdb_leaf_bytes(NANOVDB_FPN, leaf), log < 5 ? 96 + (64 << log) : 0);
    }
}

static void assert_refused(const struct nanovdb_made *made, const char *words)
{
    struct error error;

    assert_null(decode(made, &error));
    if (!strstr(error.message, words)) fail_msg("expected \"%s\" in \"%s\"", words, error.message);
}

static void damaged_leaves_and_chunks_are_refused(void **state)
{
    struct nanovdb_params params = six;
    struct nanovdb_made made;

    params.bits = NANOVDB_MAKER_VARIABLE;
    nanovdb_make(&made, &params);
    made.bytes[made.leaves + 15] = 7 << 5;
    assert_refused(&made, "names no number of bits");
    made.bytes[made.leaves + 15] = 0;
    --made.bytes[made.tree + 32]; // the tree's count of leaves
    assert_refused(&made, "expected 5 leaf nodes, got more");
    free(made.bytes);

    params = six;
    params.is_blosc = true;
    nanovdb_make(&made, &params);
    made.bytes[made.grid + 8 + 4] ^= 1; // the chunk's unpacked size
    assert_refused(&made, "Blosc: the packed grid is damaged");
    made.bytes[made.grid + 8 + 4] ^= 1;
    made.bytes[made.grid + 7] = 1; // its packed size
    assert_refused(&made, "Blosc: the packed grid is damaged");
    free(made.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantised_values_are_half_a_quantum_off_at_most),
        cmocka_unit_test(blosc_unpacks_to_the_same),
        cmocka_unit_test(codes_lie_from_the_lowest_bit_on),
        cmocka_unit_test(leaves_take_what_their_bits_need),
        cmocka_unit_test(damaged_leaves_and_chunks_are_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
