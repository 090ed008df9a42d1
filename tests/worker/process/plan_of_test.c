// SPDX-License-Identifier: Apache-2.0
#include "worker/process/plan_of.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"
#include "tests/support/ball_job.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/process/assignment.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

// A file of a frame that these settings have rendered.
static void write_file(const char *path, const char *sequence_hash, const char *quality)
{
    const struct image_exr_header header = {.fps_numerator = 24,
                                            .fps_denominator = 1,
                                            .job_hash = "",
                                            .sequence_hash = sequence_hash,
                                            .method = "midpoint",
                                            .backend = "osmesa",
                                            .renderer = "llvmpipe",
                                            .shader_hash = "",
                                            .plan = "steps suffice",
                                            .plan_number = 7,
                                            .quality = quality};
    struct image image = {0};
    int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);

    assert_true(fd >= 0);
    assert_true(image_init(&image, 4, 4, false, false, NULL));
    for (int i = 0; i < 4 * 16; i++)
        image.rgba[i] = 0.5f;
    assert_true(image_exr_write(fd, &image, &header, 1, NULL));
    image_finish(&image);
    close(fd);
}

// Reads the settings of a file for a job that states a tolerance.
static bool read_quality(void *const *state, const char *quality, struct job_quality *stated, struct error *error)
{
    struct held_job *job = held_job_create();
    struct cJSON *root = NULL;
    struct json_node document;
    bool ok;

    ball_job_parse(&job->job, BALL_JOB_SIGMA_S_1, "\"quality\": {\"tolerance\": 0.01}, " BALL_JOB_POINT_LIGHT);
    job->plan_of = xstrdup(temp_folder_path(state, "a.exr"));
    write_file(job->plan_of, job->job.hash, quality);
    assert_true(json_parse(&root, "{}", 2, NULL));
    document = json_node_root(root);
    ok = plan_of_read(job, &document, error);
    *stated = job->stated;
    json_delete(root);
    held_job_destroy(job);
    return ok;
}

static void pixels_are_repeated_with_the_other_settings(void **state)
{
    struct job_quality stated;
    struct error error = {0};

    if (!read_quality(state,
                      "{\"method\":\"midpoint\",\"step\":0.125,\"light_step\":0.25,\"samples\":1,"
                      "\"pixels\":{\"stride\":8,\"threshold\":0.0625}}",
                      &stated, &error))
        fail_msg("%s", error.message);
    assert_int_equal(stated.method, JOB_METHOD_MIDPOINT);
    assert_true(stated.step == 0.125 && stated.light_step == 0.25);
    assert_true(stated.pixels.stride == 8 && stated.pixels.threshold == 0.0625);
}

static void settings_that_no_job_may_state_are_refused(void **state)
{
    struct job_quality stated;
    struct error error = {0};

    assert_false(read_quality(state,
                              "{\"method\":\"jittered\",\"step\":0.125,\"light_step\":0.25,\"samples\":1,"
                              "\"pixels\":{\"stride\":8,\"threshold\":0.0625}}",
                              &stated, &error));
    if (!strstr(error.message, "quality.pixels")) fail_msg("expected \"quality.pixels\" in \"%s\"", error.message);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(pixels_are_repeated_with_the_other_settings, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(settings_that_no_job_may_state_are_refused, temp_folder_create,
                                        temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
