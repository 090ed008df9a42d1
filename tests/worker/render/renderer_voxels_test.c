// Sparse frames of grids: a lone voxel between the points of the first level is seen.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/gl_stage.h"
#include "tests/support/nanovdb_maker.h"
#include "tests/support/object_job.h"
#include "tests/support/shader_dir.h"
#include "tests/support/sparse_pair.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 40, WIDTH_PX = 163, HEIGHT_PX = 91 }; // voxels; neither of the others is a multiple of a stride

static const int LONE[3] = {21, 13, 27};
static const double PLACE[3] = {0.16, 0.224, 0.0}; // m: pixel (86, 38), half way between points of stride 4
static const struct job_pixels usual = {.stride = 16, .threshold = 0.01};

static float value_at(const int voxel[3])
{
    return memcmp(voxel, LONE, sizeof LONE) == 0 ? 200.0f : 0.0f;
}

static void write_dense(const char *path)
{
    static unsigned char voxels[SIDE * SIDE * SIDE];

    voxels[LONE[0] + SIDE * (LONE[1] + SIDE * LONE[2])] = 200;
    volume_maker_write(path, voxels, sizeof voxels);
}

static void write_sparse(const char *path)
{
    const struct nanovdb_params params = {.name = "density",
                                          .map = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                          .max = {SIDE - 1, SIDE - 1, SIDE - 1},
                                          .value = value_at};
    struct nanovdb_made made;

    nanovdb_make(&made, &params);
    volume_maker_write(path, made.bytes, made.size_bytes);
    free(made.bytes);
}

struct variant {
    bool is_sparse; // the grid
    double edge;    // of a voxel, m: 31 px are 1 m
    const char *density, *rest, *media;
    bool moves; // by 62 px while the shutter is open
};

static void load(struct job *job, const struct variant *variant, const char *path)
{
    double center[3];
    char scene[2048];

    for (int axis = 0; axis < 3; axis++) // that of the grid; of a sparse one, that of its first voxel
        center[axis] = PLACE[axis] - variant->edge * (LONE[axis] - (variant->is_sparse ? 0.0 : 0.5 * (SIDE - 1)));
    snprintf(
        scene, sizeof scene,
        "\"media\": [{\"emission\": 500, \"density\": {\"kind\": \"grid\", \"file\": \"%s\", \"spacing\": [%g, %g, "
        "%g], \"center\": [%.9g, %.9g, %.9g]%s}}%s]",
        path, variant->edge, variant->edge, variant->edge, center[0], center[1], center[2], variant->density,
        variant->media);
    object_job_parse(job, scene, variant->rest);
    job->width_px = WIDTH_PX;
    job->height_px = HEIGHT_PX;
    if (!variant->moves) return;
    job->scene.camera.shutter = 0.5;
    job->scene.media[0].density.grid.center.kind = TIMELINE_LINEAR; // whose start is where the constant is
    job->scene.media[0].density.grid.center.linear.rate[0] = 96.0;
}

#define STEPS_OF_4 "\"background\": 0.1, \"quality\": {\"method\": \"midpoint\", \"step\": 0.02, \"samples\": 4}"
#define STEPS "\"background\": 0.1, \"quality\": {\"method\": \"midpoint\", \"step\": 0.02}"

static void lone_voxels_are_seen(void **state)
{
    static const struct variant variants[] = {
        {false, 0.04, "", STEPS, "", false},
        {true, 0.04, "", STEPS, "", false},
        {false, 0.08, "", STEPS, "", false},
        {true, 0.08, "", STEPS, "", false},
        {false, 0.15, ", \"interpolation\": \"nearest\"", STEPS, "", false},
        {true, 0.15, ", \"interpolation\": \"nearest\"", STEPS, "", false},
        {true, 0.15, "", STEPS,
         ", {\"sigma_a\": 0.1, \"density\": {\"kind\": \"homogeneous\", \"bounds\": {\"kind\": \"sphere\", "
         "\"radius\": 2}}}",
         false},
        {false, 0.08, "", STEPS_OF_4, "", true},
        {true, 0.08, "", STEPS_OF_4, "", true},
    };
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, test_shader_dir());
    const char *paths[2] = {temp_folder_path(state, "v_40x40x40xuint8.raw"), temp_folder_path(state, "v.nvdb")};

    write_dense(paths[0]);
    write_sparse(paths[1]);
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
        struct sparse_pair pair;
        struct job job;
        int seen = 0;

        load(&job, &variants[i], paths[variants[i].is_sparse]);
        sparse_pair_render(stage.renderer, &job, 0, usual, &pair);
        for (int k = 0; k < WIDTH_PX * HEIGHT_PX; k++) {
            if (!(pair.full.rgba[4 * k] > 0.11f)) continue;
            seen++;
            assert_true(k % WIDTH_PX % 16 != 0 || k / WIDTH_PX % 16 != 0);
            assert_int_equal(pair.sparse.doubts[k], 0);
        }
        assert_in_range(seen, 4, 150);
        assert_true(sparse_pair_error(&pair) < usual.threshold);
        assert_true(pair.sparse_result.traced < 0.25);
        sparse_pair_finish(&pair);
        job_finish(&job);
    }
    gl_stage_close(stage);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(lone_voxels_are_seen, temp_folder_create, temp_folder_destroy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
