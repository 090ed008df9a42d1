// The renderer reads a scene's files once while they stay, again when they change, and never mixes two versions.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/gl_stage.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"
#include "worker/gl/gl_functions.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"
#include "worker/textures/gl_grid.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 8, VOXELS = SIDE * SIDE * SIDE };

struct stage {
    struct gl_stage gl;
    struct job job;
    struct image image;
    struct renderer_result result;
    struct error error;
    const char *path;
    int slabs;          // read during the last frame
    bool rewrites_file; // while it is read
};

static void write_even(const char *path, unsigned char value)
{
    unsigned char voxels[VOXELS];

    memset(voxels, value, sizeof voxels);
    volume_maker_write(path, voxels, sizeof voxels);
}

// `medium` has members beside the density, `density` has members beside the file.
static void take_job(struct stage *stage, const char *density, const char *medium)
{
    char text[2048];

    snprintf(text, sizeof text,
             "{ \"version\": 1, \"name\": \"grid\", \"frames\": \"0-9\", \"fps\": 24, \"resolution\": [8, 8],"
             " \"camera\": { \"position\": [0, 0, 3], \"target\": [0, 0, 0], \"up\": [0, 1, 0], \"fov\": 20 },"
             " \"scene\": { \"media\": [ { \"density\": { \"kind\": \"grid\", \"file\": \"%s\", %s } %s } ] }, "
             "\"quality\": { \"method\": \"midpoint\", \"step_voxels\": 0.5 },"
             " \"output\": { \"path\": \"grid.####.exr\" } }",
             stage->path, density, medium);
    job_finish(&stage->job);
    if (!job_parse(&stage->job, text, strlen(text), NULL, &stage->error)) fail_msg("%s", stage->error.message);
}

static struct stage open_stage(const char *path)
{
    struct stage stage = {.path = path};

    take_job(&stage, "\"scale\": 0.1", ", \"sigma_a\": 0.1");
    stage.gl = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    assert_true(image_init(&stage.image, 8, 8, false, false, NULL));
    return stage;
}

static void close_stage(struct stage *stage)
{
    image_finish(&stage->image);
    gl_stage_close(stage->gl);
    job_finish(&stage->job);
}

// Between slabs no part of the picture is done.
static bool on_progress(void *user, double done)
{
    struct stage *stage = user;

    if (done > 0) return true;
    stage->slabs++;
    if (stage->rewrites_file) write_even(stage->path, 200);
    return true;
}

static bool render(struct stage *stage, int32_t frame)
{
    stage->slabs = 0;
    return renderer_render(
        stage->gl.renderer,
        &(struct renderer_frame){
            .job = &stage->job, .frame = frame, .image = &stage->image, .on_progress = on_progress, .user = stage},
        &stage->result, &stage->error);
}

static float alpha(struct stage *stage, int32_t frame)
{
    if (!render(stage, frame)) fail_msg("%s", stage->error.message);
    return stage->image.rgba[4 * (4 * 8 + 4) + 3];
}

static void file_that_stays_is_read_once(void **state)
{
    const char *path = temp_folder_path(state, "v_8x8x8xuint8.raw");
    struct stage stage;

    write_even(path, 50);
    stage = open_stage(path);
    assert_true(alpha(&stage, 0) > 0.1f);
    assert_int_equal(stage.slabs, 1);
    assert_false(stage.result.is_copy);
    alpha(&stage, 1);
    assert_int_equal(stage.slabs, 0);
    assert_true(stage.result.is_copy); // nothing moves
    close_stage(&stage);
}

static void changed_file_is_read_again(void **state)
{
    const char *path = temp_folder_path(state, "v_8x8x8xuint8.raw");
    char first[HASH_TEXT_SIZE], hash[HASH_TEXT_SIZE];
    enum renderer_fault fault;
    struct stage stage;
    float thin, thick;

    write_even(path, 50);
    stage = open_stage(path);
    thin = alpha(&stage, 0);
    memcpy(first, stage.result.picture_hash, sizeof first);
    assert_true(renderer_hash_picture(stage.gl.renderer, &stage.job, 0, hash, &fault, NULL));
    assert_string_equal(hash, first);
    write_even(path, 100);
    assert_true(renderer_hash_picture(stage.gl.renderer, &stage.job, 0, hash, &fault, NULL));
    assert_string_not_equal(hash, first);
    thick = alpha(&stage, 0);
    assert_string_equal(hash, stage.result.picture_hash);
    assert_false(stage.result.is_copy);
    assert_true(thick > thin + 0.1f);
    close_stage(&stage);
}

// The file stays, but the transfer function changes which bricks are empty.
static void each_transfer_function_finds_its_own_empty_space(void **state)
{
    const char *path = temp_folder_path(state, "v_8x8x8xuint8.raw");
    struct stage stage;

    write_even(path, 50);
    stage = open_stage(path);
    take_job(&stage, "\"transfer_function\": [[100, 1, 1, 1, 0], [200, 1, 1, 1, 0.5]], \"unit_distance\": 0.1", "");
    assert_true(alpha(&stage, 0) == 0);
    take_job(&stage, "\"transfer_function\": [[0, 1, 1, 1, 0], [100, 1, 1, 1, 0.5]], \"unit_distance\": 0.1", "");
    assert_true(alpha(&stage, 0) > 0.5f);
    assert_int_equal(stage.slabs, 0);
    take_job(&stage, "\"transfer_function\": [[100, 1, 1, 1, 0], [200, 1, 1, 1, 0.5]], \"unit_distance\": 0.1", "");
    assert_true(alpha(&stage, 0) == 0);
    close_stage(&stage);
}

static void file_changed_while_it_is_read_fails_the_frame(void **state)
{
    const char *path = temp_folder_path(state, "v_8x8x8xuint8.raw");
    struct stage stage;

    write_even(path, 50);
    stage = open_stage(path);
    stage.rewrites_file = true;
    assert_false(render(&stage, 0));
    assert_int_equal(stage.result.fault, RENDERER_FAULT_FRAME);
    assert_non_null(strstr(stage.error.message, path));
    assert_non_null(strstr(stage.error.message, "changed"));
    stage.rewrites_file = false;
    assert_true(alpha(&stage, 0) > 0.5f);
    close_stage(&stage);
}

static void each_frame_of_a_sequence_has_its_file(void **state)
{
    struct stage stage;

    write_even(temp_folder_path(state, "v_8x8x8xuint8_00.raw"), 0);
    write_even(temp_folder_path(state, "v_8x8x8xuint8_01.raw"), 50);
    stage = open_stage(temp_folder_path(state, "v_8x8x8xuint8_##.raw"));
    assert_true(alpha(&stage, 0) == 0);
    assert_true(alpha(&stage, 1) > 0.1f);
    assert_int_equal(stage.slabs, 1);
    assert_true(alpha(&stage, 0) == 0);
    assert_int_equal(stage.slabs, 0); // still kept
    assert_false(render(&stage, 2));
    assert_int_equal(stage.result.fault, RENDERER_FAULT_FRAME);
    close_stage(&stage);
}

static void missing_file_is_the_jobs_fault(void **state)
{
    const char *path = temp_folder_path(state, "v_8x8x8xuint8.raw");
    struct stage stage = open_stage(path);

    assert_false(render(&stage, 0));
    assert_int_equal(stage.result.fault, RENDERER_FAULT_JOB);
    assert_non_null(strstr(stage.error.message, "scene.media[0].density.file: "));
    close_stage(&stage);
}

static long read_status_kilobytes(const char *key)
{
    FILE *file = fopen("/proc/self/status", "r");
    long kilobytes = 0;
    char line[256];

    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, key, strlen(key)) == 0) sscanf(line + strlen(key), ": %ld", &kilobytes);
    if (file) fclose(file);
    return kilobytes;
}

// Software GL's textures are in this process' memory. Reading takes at most 1.3 times the volume's size with the
// texture.
static void volume_is_never_held_twice(void **state)
{
    enum { BIG = 192, VOLUME_KILOBYTES = BIG * BIG * BIG * 4 / 1024 };
    const char *path = temp_folder_path(state, "v_192x192x192xfloat32.raw");
    struct stage stage = open_stage(temp_folder_path(state, "unused_8x8x8xuint8.raw"));
    struct gl_functions gl;
    struct gl_grid grid;
    struct volume *volume;
    long before, peak;
    FILE *reset = fopen("/proc/self/clear_refs", "w");

    if (!reset || fputs("5\n", reset) < 0 || fclose(reset) != 0) skip(); // the peak cannot be measured
    volume_maker_write_raw(path, (int[]){BIG, BIG, BIG}, VOLUME_STORED_FLOAT32, false);
    assert_true(gl_functions_load(&gl, stage.gl.context, NULL));
    reset = fopen("/proc/self/clear_refs", "w");
    assert_true(reset && fputs("5\n", reset) >= 0 && fclose(reset) == 0);
    before = read_status_kilobytes("VmRSS");
    assert_true(volume_open(&volume, &(struct volume_source){.path = path}, NULL));
    assert_true(gl_grid_init(&grid, &(struct gl_grid_params){.gl = &gl, .volume = volume, .path = path}, NULL));
    peak = read_status_kilobytes("VmHWM");
    print_message("%.3f times the volume\n", (double)(peak - before) / VOLUME_KILOBYTES);
    assert_true(peak - before <= 1.3 * VOLUME_KILOBYTES);
    gl_grid_finish(&grid);
    volume_close(volume);
    close_stage(&stage);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(file_that_stays_is_read_once),
        TEST(changed_file_is_read_again),
        TEST(each_transfer_function_finds_its_own_empty_space),
        TEST(file_changed_while_it_is_read_fails_the_frame),
        TEST(each_frame_of_a_sequence_has_its_file),
        TEST(missing_file_is_the_jobs_fault),
        TEST(volume_is_never_held_twice),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
