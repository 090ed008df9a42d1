// The grid's shader modules against their twin in reference/, on voxels that went through a file and a GL texture.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "reference/grid.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"
#include "tests/support/shader_probe.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"
#include "worker/density/grid_lookup.h"
#include "worker/gl/gl_functions.h"
#include "worker/textures/gl_grid.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { COUNT = 400, VOXEL_LIMIT = 40 * 40 * 40 };

static const char *const MODULES[] = {"density/grid.glsl", "density/grid_linear.glsl", "density/grid_nearest.glsl",
                                      "density/grid_bricks.glsl", NULL};

// Inputs: the columns of the matrix, the shift, size, slope and intercept, then each probe's position and direction.
static const char BODY[] =
    "layout(binding = 0) uniform %ssampler2DArray voxels;\n"
    "layout(binding = 1) uniform sampler3D bricks;\n"
    "vec4 probe(int i)\n{\n"
    "    DensityGrid grid = DensityGrid(mat3(inputs[0].xyz, inputs[1].xyz, inputs[2].xyz), inputs[3].xyz,\n"
    "                                   inputs[4].xyz, inputs[5].x, inputs[5].y);\n"
    "    vec3 p = inputs[6 + 2 * i].xyz;\n"
    "    vec3 direction = inputs[7 + 2 * i].xyz;\n"
    "    vec3 at = density_grid_index(grid, p);\n"
    "    if (inputs[5].z > 0.5) return vec4(density_grid_span(grid, p, direction), 0.0, 0.0);\n"
    "    return vec4(density_grid_linear(voxels, grid, at), density_grid_nearest(voxels, grid, at),\n"
    "                density_grid_skip(bricks, grid, at, direction), 0.0);\n"
    "}\n";

struct stage {
    const char *path;
    int size[3];
    enum volume_type type;
    double slope, intercept;
    double index_to_world[12];
    bool on_egl, asks_span;
    float values[VOXEL_LIMIT]; // slope and intercept applied
    double range;
    struct gl_grid grid;
    unsigned distances;
    float inputs[SHADER_PROBE_INPUT_LIMIT][4], outputs[COUNT][4];
};

static struct stage stage;

static const double SKEWED[12] = {0.031, 0.004, -0.002, 0.7, -0.006, 0.02, 0.005, -0.3, 0.001, 0.003, -0.055, 0.2};
// Voxels whose sides are a power of two, so that index coordinates are exact.
static const double EXACT[12] = {1.0 / 32, 0, 0, 0, 0, 1.0 / 32, 0, 0, 0, 0, 1.0 / 32, 0};

static bool is_not_positive(double min, double max, const void *user)
{
    return max <= 0;
}

static void bind(const struct gl_functions *gl, void *user)
{
    static const enum scene_voxel types[] = {SCENE_VOXEL_UINT8, SCENE_VOXEL_UINT16, SCENE_VOXEL_INT16,
                                             SCENE_VOXEL_FLOAT32};
    struct volume_source source = {.path = stage.path, .raw = {.type = types[stage.type], .has_type = true}};
    struct volume *volume;
    struct error error = {{0}};

    memcpy(source.raw.size, stage.size, sizeof stage.size);
    if (!volume_open(&volume, &source, &error) ||
        !gl_grid_init(&stage.grid, &(struct gl_grid_params){.gl = gl, .volume = volume, .path = stage.path}, &error))
        fail_msg("%s", error.message);
    volume_close(volume);
    gl->BindTextureUnit(0, stage.grid.voxels);
    stage.distances = gl_grid_create_distances(&stage.grid, stage.slope, stage.intercept, is_not_positive, NULL);
    gl->BindTextureUnit(1, stage.distances);
}

static void release(void *user)
{
    stage.grid.gl->DeleteTextures(1, &stage.distances);
    gl_grid_finish(&stage.grid);
}

static size_t voxel_count(void)
{
    return (size_t)stage.size[0] * (size_t)stage.size[1] * (size_t)stage.size[2];
}

static double extreme(enum volume_type type, bool is_high)
{
    static const double low[] = {0, 0, INT16_MIN, -1000}, high[] = {UINT8_MAX, UINT16_MAX, INT16_MAX, 1000};

    return is_high ? high[type] : low[type];
}

// Stored numbers are random over the whole range of the type, with both of its ends.
static void make_voxels(struct random *random)
{
    size_t voxel_bytes = volume_type_size(stage.type), count = voxel_count();
    unsigned char *voxels = calloc(count, voxel_bytes);

    for (size_t i = 0; i < count; i++) {
        double low = extreme(stage.type, false), high = extreme(stage.type, true);
        double stored = random_between(random, low, high + (stage.type == VOLUME_FLOAT32 ? 0 : 1));

        if (i < 2) stored = i ? high : low;
        if (stage.type != VOLUME_FLOAT32) stored = floor(stored);
        if (stage.type == VOLUME_FLOAT32) {
            float number = (float)stored;

            stored = number;
            memcpy(voxels + 4 * i, &number, 4);
        } else {
            int64_t number = (int64_t)stored; // on a little-endian machine its first bytes are the narrower type

            memcpy(voxels + voxel_bytes * i, &number, voxel_bytes);
        }
        stage.values[i] = (float)(stage.slope * stored + stage.intercept);
    }
    stage.range = fabs(stage.slope) * (extreme(stage.type, true) - extreme(stage.type, false));
    volume_maker_write(stage.path, voxels, count * voxel_bytes);
    free(voxels);
}

// Blocks of 7 voxels a side fill the inside of bricks. One block in eight is 1, all else is -1.
static void make_blocks(struct random *random)
{
    float *voxels = calloc(voxel_count(), sizeof *voxels);
    bool is_full[5 * 5 * 5];
    size_t at = 0;

    for (int i = 0; i < 5 * 5 * 5; i++)
        is_full[i] = random_between(random, 0, 8) < 1;
    for (int k = 0; k < stage.size[2]; k++)
        for (int j = 0; j < stage.size[1]; j++)
            for (int i = 0; i < stage.size[0]; i++, at++) {
                bool is_inside = i % 8 && j % 8 && k % 8;

                voxels[at] = is_inside && is_full[(k / 8 * 5 + j / 8) * 5 + i / 8] ? 1 : -1;
            }
    memcpy(stage.values, voxels, at * sizeof *voxels);
    volume_maker_write(stage.path, voxels, at * sizeof *voxels);
    free(voxels);
}

static struct grid make_twin(bool is_nearest)
{
    struct grid_params params = {.values = stage.values, .is_nearest = is_nearest};
    struct grid grid;

    memcpy(params.size, stage.size, sizeof params.size);
    memcpy(params.index_to_world, stage.index_to_world, sizeof params.index_to_world);
    grid_init(&grid, &params);
    return grid;
}

static struct vec3 to_world(struct vec3 index)
{
    const double *m = stage.index_to_world;

    return (struct vec3){m[0] * index.x + m[1] * index.y + m[2] * index.z + m[3],
                         m[4] * index.x + m[5] * index.y + m[6] * index.z + m[7],
                         m[8] * index.x + m[9] * index.y + m[10] * index.z + m[11]};
}

static void put(size_t at, struct vec3 v)
{
    stage.inputs[at][0] = (float)v.x;
    stage.inputs[at][1] = (float)v.y;
    stage.inputs[at][2] = (float)v.z;
}

static struct vec3 position_of(size_t probe)
{
    const float *input = stage.inputs[6 + 2 * probe];

    return (struct vec3){input[0], input[1], input[2]};
}

static struct vec3 direction_of(size_t probe)
{
    const float *input = stage.inputs[7 + 2 * probe];

    return (struct vec3){input[0], input[1], input[2]};
}

// Positions are in the box and a voxel around it, at multiples of a voxel over `grain`.
static void put_probes(struct random *random, double grain)
{
    const double *m = make_twin(false).world_to_index;

    for (int column = 0; column < 3; column++)
        put((size_t)column, (struct vec3){m[column], m[4 + column], m[8 + column]});
    put(3, (struct vec3){m[3], m[7], m[11]});
    put(4, (struct vec3){stage.size[0], stage.size[1], stage.size[2]});
    put(5, (struct vec3){stage.slope, stage.intercept, stage.asks_span});
    for (size_t i = 0; i < COUNT; i++) {
        double index[3], direction[3], length = 0;

        for (int axis = 0; axis < 3; axis++) {
            index[axis] = floor(grain * random_between(random, -1.5, stage.size[axis] + 0.5)) / grain;
            // Some directions are along an axis of the world.
            direction[axis] = i % 8 < 3 && (int)(i % 8) != axis ? 0 : random_between(random, -1, 1);
            length = hypot(length, direction[axis]);
        }
        put(6 + 2 * i, to_world((struct vec3){index[0], index[1], index[2]}));
        put(7 + 2 * i, (struct vec3){direction[0] / length, direction[1] / length, direction[2] / length});
    }
}

static void probe(void)
{
    char body[sizeof BODY + 8];

    snprintf(body, sizeof body, BODY, grid_lookup_sampler_prefix(stage.type));
    shader_probe_run(&(struct shader_probe_params){.modules = MODULES,
                                                   .body = body,
                                                   .inputs = (const float(*)[4])stage.inputs,
                                                   .input_count = 6 + 2 * COUNT,
                                                   .count = COUNT,
                                                   .on_egl = stage.on_egl,
                                                   .bind = bind,
                                                   .release = release},
                     stage.outputs);
}

static void set_up(void **state, const int size[3], enum volume_type type, double slope, double intercept,
                   const double index_to_world[12])
{
    stage.path = temp_folder_path(state, "voxels.raw");
    memcpy(stage.size, size, sizeof stage.size);
    stage.type = type;
    stage.slope = slope;
    stage.intercept = intercept;
    memcpy(stage.index_to_world, index_to_world, sizeof stage.index_to_world);
    stage.asks_span = false;
}

static bool is_near_a_face(const struct grid *grid, struct vec3 p)
{
    const double *m = grid->world_to_index;
    bool is_near = false;

    for (int row = 0; row < 3; row++) {
        double index = m[4 * row] * p.x + m[4 * row + 1] * p.y + m[4 * row + 2] * p.z + m[4 * row + 3];

        is_near = is_near || fabs(index - floor(index) - 0.5) < 1e-4;
    }
    return is_near;
}

static void check_values(double tolerance)
{
    struct grid linear = make_twin(false), nearest = make_twin(true);

    for (size_t i = 0; i < COUNT; i++) {
        struct vec3 p = position_of(i);

        assert_near(stage.outputs[i][0], grid_value(&linear, p), tolerance * stage.range);
        if (!is_near_a_face(&nearest, p)) assert_near(stage.outputs[i][1], grid_value(&nearest, p), 1e-6 * stage.range);
    }
}

static const int SIZES[][3] = {{23, 9, 31}, {1, 1, 1}, {2, 1, 1}, {1, 2, 3}, {40, 40, 40}};

// Index coordinates are exact. The error is a dozen roundings of numbers up to the range, 2^-24 of it each.
static void values_of_every_type_are_the_twins(void **state)
{
    struct random random = {17};

    for (int backend = 0; backend < 2; backend++)
        for (size_t i = 0; i < sizeof SIZES / sizeof SIZES[0]; i++)
            for (enum volume_type type = VOLUME_UINT8; type <= VOLUME_FLOAT32; type++) {
                stage.on_egl = backend;
                set_up(state, SIZES[i], type, i % 2 ? -0.25 : 3, i % 2 ? 100 : 0, EXACT);
                make_voxels(&random);
                put_probes(&random, 64);
                probe();
                check_values(1e-6);
            }
}

// A world position of up to 2 m is rounded by 2^-24 of it, which is 6e-6 of the thinnest voxel here. The matrix adds a
// few such roundings. A value may change by three times the range from one voxel to the next, once along each axis.
static void oblique_flat_mirrored_voxels_are_the_twins(void **state)
{
    struct random random = {18};

    for (size_t i = 0; i < sizeof SIZES / sizeof SIZES[0]; i++) {
        set_up(state, SIZES[i], VOLUME_UINT16, 0.001, -5, SKEWED);
        make_voxels(&random);
        put_probes(&random, 1e6);
        probe();
        check_values(1e-4);
    }
}

// A ramp of 8-bit voxels is a straight line between their centres, not a staircase of 256 steps.
static void eight_bits_are_interpolated_as_floats(void **state)
{
    unsigned char ramp[40];
    struct random random = {19};

    set_up(state, (int[]){40, 1, 1}, VOLUME_UINT8, 1.0 / 255, 0, EXACT);
    for (int i = 0; i < 40; i++) {
        ramp[i] = (unsigned char)(3 * i);
        stage.values[i] = (float)(3 * i / 255.0);
    }
    volume_maker_write(stage.path, ramp, sizeof ramp);
    put_probes(&random, 4096);
    probe();
    for (size_t i = 0; i < COUNT; i++) {
        double at = fmin(fmax(32.0 * position_of(i).x, 0), 39);

        assert_near(stage.outputs[i][0], 3 * at / 255, 1e-6);
    }
}

// Interpolation between voxels of value 0 gives exactly 0, so that no haze is around what a scan shows.
static void voxels_of_zero_give_exactly_zero(void **state)
{
    struct random random = {22};

    for (enum volume_type type = VOLUME_UINT8; type <= VOLUME_FLOAT32; type++) {
        int64_t stored = type == VOLUME_UINT8 ? 200 : 1024;
        float number = (float)stored;
        unsigned char voxels[27 * 4];

        set_up(state, (int[]){3, 3, 3}, type, 0.5, -0.5 * (double)stored, SKEWED);
        for (size_t i = 0; i < 27; i++) {
            const void *bytes = type == VOLUME_FLOAT32 ? (const void *)&number : &stored;

            memcpy(voxels + i * volume_type_size(type), bytes, volume_type_size(type));
        }
        volume_maker_write(stage.path, voxels, 27 * volume_type_size(type));
        put_probes(&random, 1e6);
        probe();
        for (size_t i = 0; i < COUNT; i++)
            assert_true(stage.outputs[i][0] == 0 && stage.outputs[i][1] == 0);
    }
}

static void spans_end_half_a_voxel_beyond_the_outer_centres(void **state)
{
    struct random random = {20};
    size_t hits = 0;

    set_up(state, SIZES[0], VOLUME_UINT8, 1, 0, SKEWED);
    make_voxels(&random);
    stage.asks_span = true;
    put_probes(&random, 1e6);
    probe();
    for (size_t i = 0; i < COUNT; i++) {
        struct grid grid = make_twin(false);
        struct vec3 p = position_of(i), d = direction_of(i);
        float near = stage.outputs[i][0], far = stage.outputs[i][1];
        // Roundings of the position and of quotients of it are some 2^-21 m, and more where the ray grazes a face.
        double shift = 2e-5;

        if (near > far) {
            for (double at = -3; at < 3; at += 0.01)
                if (grid_contains(&grid, vec3_add(p, vec3_scale(d, at)))) assert_true(far - near < shift);
            continue;
        }
        if (far - near < 4 * shift) continue;
        hits++;
        assert_true(grid_contains(&grid, vec3_add(p, vec3_scale(d, near + shift))));
        assert_true(grid_contains(&grid, vec3_add(p, vec3_scale(d, far - shift))));
        assert_false(grid_contains(&grid, vec3_add(p, vec3_scale(d, near - shift))));
        assert_false(grid_contains(&grid, vec3_add(p, vec3_scale(d, far + shift))));
    }
    assert_true(hits > COUNT / 4);
}

static void skipped_stretches_are_empty_and_long(void **state)
{
    struct random random = {21};
    double skipped = 0;

    set_up(state, (int[]){40, 37, 40}, VOLUME_FLOAT32, 1, 0, SKEWED);
    make_blocks(&random);
    put_probes(&random, 1e6);
    probe();
    for (size_t i = 0; i < COUNT; i++) {
        struct grid grid = make_twin(false);
        struct vec3 p = position_of(i), d = direction_of(i);
        // Rounding decides in the last hundred-thousandth of a skip. Skips count within the box only.
        double end = stage.outputs[i][2] * (1 - 1e-5);

        assert_true(stage.outputs[i][2] >= 0);
        skipped += fmin(end, 1) / COUNT;
        for (double at = 0; at < fmin(end, 2); at += 1e-3) {
            struct vec3 q = vec3_add(p, vec3_scale(d, at));

            if (grid_contains(&grid, q)) assert_true(grid_value(&grid, q) <= 0);
        }
    }
    assert_true(skipped > 0.1); // bricks are some 0.25 m long here
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(values_of_every_type_are_the_twins, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(oblique_flat_mirrored_voxels_are_the_twins, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(eight_bits_are_interpolated_as_floats, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(voxels_of_zero_give_exactly_zero, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(spans_end_half_a_voxel_beyond_the_outer_centres, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(skipped_stretches_are_empty_and_long, temp_folder_create, temp_folder_destroy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
