// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/scene_inputs.h"

#include "core/base/error.h"
#include "tests/support/assert_near.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const int SIZE[3] = {5, 4, 3};

// A job with one grid; what it points to is the caller's.
static struct job make_job(char *file)
{
    struct job job = {.hash = "0123456789abcdef0123456789abcdef",
                      .quality = {.method = JOB_METHOD_MIDPOINT, .step = 0.01}};
    struct scene_density *density = &job.scene.media[0].density;

    job.scene.camera.clip_far = INFINITY;
    job.scene.medium_count = 1;
    density->kind = SCENE_DENSITY_GRID;
    density->grid.file = file;
    return job;
}

static char *write_volume(void **state, const char *name)
{
    char *path = strdup(temp_folder_path(state, name));

    volume_maker_write_raw(path, SIZE, VOLUME_STORED_UINT8, false);
    return path;
}

static void expect_error(const struct job *job, int32_t frame, bool wanted_lasting, const char *wanted)
{
    struct scene_inputs inputs;
    struct error error = {{0}};
    bool is_lasting;

    assert_false(scene_inputs_open(&inputs, job, frame, NULL, &is_lasting, &error));
    if (!strstr(error.message, wanted)) fail_msg("expected \"%s\", got \"%s\"", wanted, error.message);
    assert_int_equal(is_lasting, wanted_lasting);
}

static void read_hash(const struct job *job, struct file_hashes *hashes, char hash[static HASH_TEXT_SIZE])
{
    struct scene_inputs inputs;
    struct error error = {{0}};

    if (!scene_inputs_open(&inputs, job, 0, &(struct scene_files){.hashes = hashes}, NULL, &error))
        fail_msg("%s", error.message);
    memcpy(hash, inputs.picture_hash, HASH_TEXT_SIZE);
    scene_inputs_finish(&inputs);
}

static void job_without_files_keeps_its_hash(void **state)
{
    struct file_hashes *hashes = file_hashes_create();
    struct job job = make_job(NULL);
    char hash[HASH_TEXT_SIZE];

    job.scene.media[0].density.kind = SCENE_DENSITY_HOMOGENEOUS;
    read_hash(&job, hashes, hash);
    assert_string_equal(hash, job.hash);
    file_hashes_destroy(hashes);
}

static void picture_depends_on_what_a_file_holds(void **state)
{
    char *file = write_volume(state, "head_5x4x3xuint8.raw"), *copy = write_volume(state, "copy_5x4x3xuint8.raw");
    struct file_hashes *hashes = file_hashes_create();
    struct job job = make_job(file);
    char first[HASH_TEXT_SIZE], again[HASH_TEXT_SIZE], changed[HASH_TEXT_SIZE];
    unsigned char voxels[60] = {7};

    read_hash(&job, hashes, first);
    assert_string_not_equal(first, job.hash);
    read_hash(&job, hashes, again);
    assert_string_equal(again, first);
    // Another file of the same contents gives the same picture.
    job.scene.media[0].density.grid.file = copy;
    read_hash(&job, hashes, again);
    assert_string_equal(again, first);
    // The same size, and within a tick of the file system's clock.
    job.scene.media[0].density.grid.file = file;
    volume_maker_write(file, voxels, sizeof voxels);
    read_hash(&job, hashes, changed);
    assert_string_not_equal(changed, first);
    // The same bytes are read as other voxels.
    job.scene.media[0].density.grid.raw = (struct scene_raw){.size = {4, 5, 3}};
    read_hash(&job, hashes, again);
    assert_string_not_equal(again, changed);
    file_hashes_destroy(hashes);
    free(file);
    free(copy);
}

static void changed_file_is_noticed(void **state)
{
    char *file = write_volume(state, "head_5x4x3xuint8.raw");
    struct file_hashes *hashes = file_hashes_create();
    struct job job = make_job(file);
    struct error error = {{0}};
    struct scene_inputs inputs;

    assert_true(scene_inputs_open(&inputs, &job, 0, &(struct scene_files){.hashes = hashes}, NULL, NULL));
    assert_true(scene_input_check(&inputs.media[0], NULL));
    assert_int_equal(unlink(file), 0);
    assert_false(scene_input_check(&inputs.media[0], NULL));
    volume_maker_write_raw(file, (int[]){5, 4, 4}, VOLUME_STORED_UINT8, false);
    assert_false(scene_input_check(&inputs.media[0], &error));
    assert_non_null(strstr(error.message, "head_5x4x3xuint8.raw: it changed"));
    scene_inputs_finish(&inputs);
    file_hashes_destroy(hashes);
    free(file);
}

static void both_files_of_a_detached_header_count(void **state)
{
    char *header = strdup(temp_folder_path(state, "head.nhdr"));
    static const char text[] = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 5 4 3\nspacings: 1 1 1\nencoding: raw\n"
                               "data file: head.bin\n";
    char *voxels = write_volume(state, "head.bin");
    struct file_hashes *hashes = file_hashes_create();
    char first[HASH_TEXT_SIZE], second[HASH_TEXT_SIZE];
    unsigned char other[60] = {1};
    struct job job = make_job(header);

    volume_maker_write(header, text, strlen(text));
    read_hash(&job, hashes, first);
    volume_maker_write(voxels, other, sizeof other);
    read_hash(&job, hashes, second);
    assert_string_not_equal(first, second);
    file_hashes_destroy(hashes);
    free(header);
    free(voxels);
}

static void number_signs_stand_for_the_frame(void **state)
{
    char *first = write_volume(state, "s_5x4x3xuint8_0007.raw");
    char *name = strdup(temp_folder_path(state, "s_5x4x3xuint8_####.raw"));
    struct job job = make_job(name);
    struct scene_inputs inputs;

    assert_true(scene_inputs_open(&inputs, &job, 7, NULL, NULL, NULL));
    assert_string_equal(inputs.media[0].path, first);
    assert_true(inputs.media[0].is_sequence);
    scene_inputs_finish(&inputs);
    // The next frame's file may not be there yet.
    expect_error(&job, 8, false, "s_5x4x3xuint8_0008.raw");
    free(name);
    free(first);
}

static void missing_file_is_told_with_its_place(void **state)
{
    char *name = strdup(temp_folder_path(state, "none_5x4x3xuint8.raw"));
    struct job job = make_job(name);

    expect_error(&job, 0, true, "scene.media[0].density.file: ");
    expect_error(&job, 0, true, "none_5x4x3xuint8.raw: ");
    free(name);
}

static void steps_in_voxels_become_metres(void **state)
{
    char *file = write_volume(state, "head_5x4x3xuint8.raw");
    struct job job = make_job(file);
    struct scene_inputs inputs;

    job.quality = (struct job_quality){.method = JOB_METHOD_MIDPOINT, .step_voxels = 0.5, .light_step_voxels = 2};
    memcpy(job.scene.media[0].density.grid.spacing, (double[]){0.3, 0.2, 0.4}, 3 * sizeof(double));
    job.scene.media[1] = job.scene.media[0];
    job.scene.medium_count = 2;
    memcpy(job.scene.media[1].density.grid.spacing, (double[]){0.5, 0.1, 0.4}, 3 * sizeof(double));
    assert_true(scene_inputs_open(&inputs, &job, 0, NULL, NULL, NULL));
    assert_near(inputs.quality.step, 0.05, 1e-15);
    assert_near(inputs.quality.light_step, 0.2, 1e-15);
    scene_inputs_finish(&inputs);
    free(file);
}

static void too_many_steps_are_refused(void **state)
{
    char *file = write_volume(state, "head_5x4x3xuint8.raw");
    struct job job = make_job(file);

    job.quality = (struct job_quality){.method = JOB_METHOD_MIDPOINT, .step_voxels = 1e-5};
    expect_error(&job, 0, true, "quality.step_voxels: expected at most 200000 steps along a ray, got 707107");
    job.quality = (struct job_quality){.method = JOB_METHOD_MIDPOINT, .step = 1e-6};
    expect_error(&job, 0, true, "quality.step: expected at most 200000 steps");
    job.quality = (struct job_quality){.method = JOB_METHOD_MIDPOINT, .step = 0.1, .light_step = 1e-6};
    job.scene.light_count = 1;
    expect_error(&job, 0, true, "quality.light_step: expected at most 60000 steps");
    free(file);
}

static void middle_is_put_where_the_job_wants_it(void **state)
{
    char *file = write_volume(state, "head_5x4x3xuint8.raw");
    struct job job = make_job(file);
    struct scene_grid *grid = &job.scene.media[0].density.grid;
    struct scene_inputs inputs;
    double matrix[12];

    grid->has_center = true;
    grid->center = (struct timeline){.component_count = 3, .value = {1, 2, 3}};
    assert_true(scene_inputs_open(&inputs, &job, 0, NULL, NULL, NULL));
    scene_input_find_matrix(&inputs.media[0], 0, matrix);
    for (int row = 0; row < 3; row++) {
        double middle = matrix[4 * row + 3];

        for (int axis = 0; axis < 3; axis++)
            middle += matrix[4 * row + axis] * 0.5 * (SIZE[axis] - 1);
        assert_near(middle, 1 + row, 1e-12);
    }
    scene_inputs_finish(&inputs);
    free(file);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(job_without_files_keeps_its_hash),
        TEST(picture_depends_on_what_a_file_holds),
        TEST(changed_file_is_noticed),
        TEST(both_files_of_a_detached_header_count),
        TEST(number_signs_stand_for_the_frame),
        TEST(missing_file_is_told_with_its_place),
        TEST(steps_in_voxels_become_metres),
        TEST(too_many_steps_are_refused),
        TEST(middle_is_put_where_the_job_wants_it),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
