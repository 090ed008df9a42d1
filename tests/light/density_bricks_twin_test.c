// The sparse grid's shader modules against their twin in reference/, on voxels from a file, in GL textures.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "reference/grid.h"
#include "tests/support/assert_near.h"
#include "tests/support/nanovdb_maker.h"
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"
#include "worker/density/affine.h"
#include "worker/gl/gl_functions.h"
#include "worker/sparse/sparse_grid.h"
#include "worker/sparse/volume_nanovdb.h"
#include "worker/textures/gl_bricks.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { COUNT = 400 };

static const char *const MODULES[] = {"density/bricks.glsl", "density/bricks_linear.glsl",
                                      "density/bricks_nearest.glsl", NULL};

// Inputs: the columns of the matrix, the shift, the box's two corners, then each probe's position and direction.
static const char BODY[] =
    "layout(binding = 0) uniform sampler2DArray atlas;\n"
    "layout(binding = 1) uniform usampler3D index;\n"
    "vec4 probe(int i)\n{\n"
    "    DensityBricks grid = DensityBricks(mat3(inputs[0].xyz, inputs[1].xyz, inputs[2].xyz),\n"
    "                                       inputs[3].xyz, inputs[4].xyz, inputs[5].xyz);\n"
    "    vec3 p = inputs[6 + 2 * i].xyz;\n"
    "    vec3 direction = inputs[7 + 2 * i].xyz;\n"
    "    if (inputs[0].w > 0.5) return vec4(density_bricks_span(grid, p, direction), 0.0, 0.0);\n"
    "    vec3 at = density_bricks_at(grid, p);\n"
    "    uvec4 brick = density_bricks_find(index, at);\n"
    "    if (brick.w > 0u) return vec4(0.0, 0.0, density_bricks_skip(grid, brick, at, direction), 1.0);\n"
    "    return vec4(density_bricks_linear(atlas, brick, at),\n"
    "                density_bricks_nearest(atlas, brick, at), 0.0, 0.0);\n"
    "}\n";

struct stage {
    bool on_egl, asks_span;
    struct sparse_grid *sparse; // owned
    struct brick_atlas *atlas;  // owned
    struct gl_bricks bricks;
    float *values; // owned; of the box and of one voxel around it
    int size[3];
    float inputs[SHADER_PROBE_INPUT_LIMIT][4], outputs[COUNT][4];
};

static struct stage stage;

static const double SKEWED[12] = {0.031, 0.004, -0.002, 0.7, -0.006, 0.02, 0.005, -0.3, 0.001, 0.003, -0.055, 0.2};
static const double PLAIN[12] = {1.0 / 32, 0, 0, 0, 0, 1.0 / 32, 0, 0, 0, 0, 1.0 / 32, 0};

// Clumps of 16 voxels a side in empty space. Neighbouring voxels differ.
static float clumps(const int voxel[3])
{
    int cell = (voxel[0] >> 4) * 7 + (voxel[1] >> 4) * 5 + (voxel[2] >> 4) * 3;

    if ((cell & 3) != 0) return 0;
    return (float)(1 + ((voxel[0] * 37 + voxel[1] * 101 + voxel[2] * 17) & 63)) / 64;
}

static void bind(const struct gl_functions *gl, void *user)
{
    struct error error = {{0}};

    if (!gl_bricks_init(&stage.bricks, gl, stage.atlas, &error)) fail_msg("%s", error.message);
    gl->BindTextureUnit(0, stage.bricks.values[0]);
    gl->BindTextureUnit(1, stage.bricks.index);
}

static void release(void *user)
{
    gl_bricks_finish(&stage.bricks);
}

static void copy_values(void)
{
    size_t n = 0;
    int voxel[3];

    for (int axis = 0; axis < 3; axis++)
        stage.size[axis] = stage.sparse->voxel_max[axis] - stage.sparse->voxel_min[axis] + 3;
    stage.values = malloc((size_t)stage.size[0] * (size_t)stage.size[1] * (size_t)stage.size[2] * sizeof(float));
    for (int k = 0; k < stage.size[2]; k++)
        for (int j = 0; j < stage.size[1]; j++)
            for (int i = 0; i < stage.size[0]; i++) {
                voxel[0] = stage.sparse->voxel_min[0] - 1 + i;
                voxel[1] = stage.sparse->voxel_min[1] - 1 + j;
                voxel[2] = stage.sparse->voxel_min[2] - 1 + k;
                stage.values[n++] = sparse_grid_at(stage.sparse, voxel);
            }
}

static void open_stage(const double map[12])
{
    struct nanovdb_params params = {.name = "density", .min = {-21, 3, -9}, .max = {40, 45, 30}, .value = clumps};
    struct error error = {{0}};
    struct nanovdb_made made;
    double inverse[9], shift[3];

    stage = (struct stage){0};
    memcpy(params.map, map, sizeof params.map);
    nanovdb_make(&made, &params);
    stage.sparse = volume_nanovdb_decode(&(struct nanovdb_bytes){made.bytes, made.size_bytes}, NULL, &error);
    free(made.bytes);
    if (!stage.sparse) fail_msg("%s", error.message);
    stage.atlas = brick_atlas_create(&(struct brick_atlas_params){.density = stage.sparse}, &error);
    if (!stage.atlas) fail_msg("%s", error.message);
    copy_values();
    affine_invert(map, inverse, shift);
    for (int axis = 0; axis < 3; axis++) {
        int first = SPARSE_BRICK_SIDE * stage.atlas->brick_min[axis];

        for (int row = 0; row < 3; row++)
            stage.inputs[axis][row] = (float)inverse[3 * axis + row];
        stage.inputs[3][axis] = (float)(shift[axis] - first);
        stage.inputs[4][axis] = (float)(stage.atlas->voxel_min[axis] - 1 - first);
        stage.inputs[5][axis] = (float)(stage.atlas->voxel_max[axis] + 1 - first);
    }
}

static void close_stage(void)
{
    brick_atlas_destroy(stage.atlas);
    sparse_grid_destroy(stage.sparse);
    free(stage.values);
}

static void run(void)
{
    stage.inputs[0][3] = stage.asks_span;
    shader_probe_run(&(struct shader_probe_params){.modules = MODULES,
                                                   .body = BODY,
                                                   .inputs = (const float(*)[4])stage.inputs,
                                                   .input_count = 6 + 2 * COUNT,
                                                   .count = COUNT,
                                                   .on_egl = stage.on_egl,
                                                   .bind = bind,
                                                   .release = release},
                     stage.outputs);
}

static void set_point(int i, const double map[12], const double index[3])
{
    for (int row = 0; row < 3; row++)
        stage.inputs[6 + 2 * i][row] = (float)(map[4 * row] * index[0] + map[4 * row + 1] * index[1] +
                                               map[4 * row + 2] * index[2] + map[4 * row + 3]);
}

// Puts a third of the points anywhere, a third within a voxel of the faces between bricks, and a third at voxel centres
// or halfway between two.
static void place_points(struct random *random, const double map[12])
{
    for (int i = 0; i < COUNT; i++) {
        double index[3], square = 0;

        for (int axis = 0; axis < 3; axis++) {
            double low = stage.sparse->voxel_min[axis] - 1 + 1e-3, high = stage.sparse->voxel_max[axis] + 1 - 1e-3;
            double at = random_between(random, low, high);

            if (i % 3 == 1) at = 8 * round(at / 8) + random_between(random, -1, 1);
            if (i % 3 == 2) at = round(2 * at) / 2 + 1e-3;
            index[axis] = fmin(fmax(at, low), high);
        }
        set_point(i, map, index);
        for (int axis = 0; axis < 3; axis++) {
            stage.inputs[7 + 2 * i][axis] = (float)random_between(random, -1, 1);
            square += pow((double)stage.inputs[7 + 2 * i][axis], 2);
        }
        for (int axis = 0; axis < 3; axis++)
            stage.inputs[7 + 2 * i][axis] /= (float)sqrt(square);
    }
}

static struct grid twin_of(const double map[12], bool is_nearest)
{
    struct grid_params params = {.values = stage.values, .is_nearest = is_nearest, .is_padded = true};
    struct grid twin;

    memcpy(params.size, stage.size, sizeof params.size);
    memcpy(params.index_to_world, map, sizeof params.index_to_world);
    for (int row = 0; row < 3; row++)
        for (int axis = 0; axis < 3; axis++)
            params.index_to_world[4 * row + 3] += map[4 * row + axis] * (stage.sparse->voxel_min[axis] - 1);
    grid_init(&twin, &params);
    return twin;
}

static struct vec3 point_at(int i)
{
    const float *p = stage.inputs[6 + 2 * i];

    return (struct vec3){(double)p[0], (double)p[1], (double)p[2]};
}

// Lattice coordinates of up to 100 are off by some 1e-5 of a voxel in floats. Neighbouring voxels differ by at most 1.
static const double tolerance = 1e-4;

static void check_values(const double map[12])
{
    struct random random = {5};
    struct grid linear, nearest;
    int with_density = 0, apart = 0;

    place_points(&random, map);
    run();
    linear = twin_of(map, false);
    nearest = twin_of(map, true);
    for (int i = 0; i < COUNT; i++) {
        struct vec3 p = point_at(i);

        assert_near((double)stage.outputs[i][0], grid_value(&linear, p), tolerance);
        with_density += stage.outputs[i][0] > 0;
        // Either of two voxels may be the nearest halfway between their centres.
        if (fabs((double)stage.outputs[i][1] - grid_value(&nearest, p)) > tolerance) apart++;
    }
    assert_true(with_density > COUNT / 10);
    assert_true(apart < COUNT / 50);
}

static void values_are_those_of_the_reference(void **state)
{
    for (int egl = 0; egl < 2; egl++) {
        open_stage(SKEWED);
        stage.on_egl = egl;
        check_values(SKEWED);
        close_stage();
        open_stage(PLAIN);
        stage.on_egl = egl;
        check_values(PLAIN);
        close_stage();
    }
}

// The reference is 0 along the distance that a skip promises, and skips are a good part of an empty brick.
static void only_empty_space_is_skipped(void **state)
{
    struct random random = {9};
    struct grid twin;
    int skips = 0;
    double skipped = 0;

    open_stage(SKEWED);
    place_points(&random, SKEWED);
    run();
    twin = twin_of(SKEWED, false);
    for (int i = 0; i < COUNT; i++) {
        const float *direction = stage.inputs[7 + 2 * i];
        double length = (double)stage.outputs[i][2];

        if (stage.outputs[i][3] == 0) continue;
        skips++;
        skipped += length;
        for (int n = 0; n < 50; n++) {
            double at = length * (n + 0.5) / 50;
            struct vec3 p = point_at(i);

            p = (struct vec3){p.x + at * (double)direction[0], p.y + at * (double)direction[1],
                              p.z + at * (double)direction[2]};
            if (grid_contains(&twin, p)) assert_near(grid_value(&twin, p), 0, tolerance);
        }
    }
    assert_true(skips > COUNT / 20 && skipped / skips > 0.05); // a brick is 0.16 to 0.44 m a side
    close_stage();
}

// The box ends one voxel beyond the outermost active centres.
static void rays_meet_the_box_where_it_is(void **state)
{
    open_stage(PLAIN);
    stage.asks_span = true;
    for (int i = 0; i < COUNT; i++) {
        set_point(i, PLAIN, (const double[]){-100, 3 - 2 + 0.1 * i, 10});
        stage.inputs[7 + 2 * i][0] = 1;
    }
    run();
    for (int i = 0; i < COUNT; i++) {
        double j = 3 - 2 + 0.1 * i;
        bool is_hit = (double)stage.outputs[i][0] < (double)stage.outputs[i][1];

        if (fabs(j - 2) < 0.01 || fabs(j - 46) < 0.01) continue; // along a face
        assert_int_equal(is_hit, j > 2 && j < 46);
        if (!is_hit) continue;
        assert_near((double)stage.outputs[i][0], (-22 + 100) / 32.0, 1e-5);
        assert_near((double)stage.outputs[i][1], (41 + 100) / 32.0, 1e-5);
    }
    close_stage();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_those_of_the_reference),
        cmocka_unit_test(only_empty_space_is_skipped),
        cmocka_unit_test(rays_meet_the_box_where_it_is),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
