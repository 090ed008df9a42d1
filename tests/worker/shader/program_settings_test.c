// Settings that differ in numbers have one program.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job_json.h"
#include "tests/support/ball_job.h"
#include "tests/support/example_job.h"
#include "worker/scene/scene_inputs.h"
#include "worker/shader/scene_program.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void name_program(const struct job *job, char hash[static HASH_TEXT_SIZE])
{
    struct scene_program program;
    struct scene_inputs inputs = {0};
    struct error error = {{0}};

    if (!scene_inputs_open(&inputs, job, 0, NULL, NULL, &error) ||
        !scene_program_init(&program, job, &inputs, NULL, &error))
        fail_msg("%s", error.message);
    memcpy(hash, program.text_hash, HASH_TEXT_SIZE);
    scene_program_finish(&program);
    scene_inputs_finish(&inputs);
}

static void assert_same_program(const struct job *job, const struct job_quality *quality)
{
    char hash[HASH_TEXT_SIZE], other[HASH_TEXT_SIZE];
    struct job changed = *job;

    changed.quality = *quality;
    name_program(job, hash);
    name_program(&changed, other);
    assert_string_equal(other, hash);
}

// Charts, drafts, plans and stated settings link one program for each method. Constant are numbers that size arrays,
// and density_grid: cells decide how many octaves are in the grid.
static void settings_of_a_method_share_a_program(void **state)
{
    static const char *const methods[] = {
        "\"method\": \"riemann\", \"step\": 0.05, \"light_steps\": 16",
        "\"method\": \"midpoint\", \"step\": 0.05, \"light_step\": 0.1",
        ("\"method\": \"jittered\", \"step\": 0.05, \"light_step\": 0.1, "
         "\"roulette\": {\"below\": 0.2, \"survive\": 0.5}"),
        "\"method\": \"adaptive\", \"step\": 0.05, \"light_step\": 0.1, \"depth_step\": 0.1",
        "\"method\": \"gauss\", \"step\": 0.05, \"light_step\": 0.1, \"order\": 4",
        "\"method\": \"cached\", \"step\": 0.05, \"light_grid\": 16, \"density_grid\": 32",
        "\"method\": \"tracking\", \"estimator\": \"ratio\", \"samples\": 2",
    };

    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        struct error error = {{0}};
        struct job_quality finer;
        struct job job;
        char text[2048];

        snprintf(text, sizeof text,
                 "{\"version\":1,\"name\":\"a\",\"frames\":\"0-9\",\"fps\":24,\"resolution\":[64,36],\"camera\":"
                 "{\"position\":[0,0,-3],\"target\":[0,0,0],\"fov\":45,\"clip\":[1,5]},%s,\"scene\":{\"media\":["
                 "{\"sigma_s\":1,\"density\":{\"kind\":\"noise\",\"frequency\":2,\"octaves\":4,\"bounds\":{\"kind\":"
                 "\"sphere\","
                 "\"center\":[0,0,0],\"radius\":1}}}]},\"output\":{\"path\":\"a.####.exr\"},\"quality\":{%s%s}}",
                 BALL_JOB_POINT_LIGHT, methods[i], i == 6 ? "" : ", \"min_transmittance\": 0.01");
        if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s: %s", methods[i], error.message);
        finer = job.quality;
        finer.step *= 0.3;
        finer.light_step *= 0.6;
        finer.depth_step *= 0.5;
        finer.light_steps *= 3;
        finer.light_grid *= 2;
        finer.min_transmittance *= 0.1;
        finer.roulette_below *= 0.5;
        finer.roulette_survive *= 0.9;
        finer.samples *= i == 6 ? 4 : 1;
        assert_same_program(&job, &finer);
        finer.min_transmittance = 0;
        assert_same_program(&job, &finer);
        job_finish(&job);
    }
}

// Lights of a kind have one program that marches from the nodes of their grids, moving or not.
static void light_grids_share_a_program(void **state)
{
    struct scene_program program;
    struct job job;

    ball_job_parse(&job, BALL_JOB_SIGMA_S_1,
                   "\"lights\": [{\"kind\": \"point\", \"intensity\": 3, \"position\": [2, 1, 2]},"
                   "{\"kind\": \"point\", \"intensity\": 1, \"position\": [-2, 1, 3]}], \"quality\": {\"method\": "
                   "\"cached\", \"step\": 0.05, \"light_grid\": 16}");
    assert_true(scene_program_init(&program, &job, NULL, NULL, NULL));
    assert_int_equal(program.cache_count, 4);
    assert_string_equal(program.caches[0].name, "light_0_marched");
    assert_string_equal(program.caches[2].name, "light_1_marched");
    assert_string_equal(program.caches[0].hash, program.caches[2].hash);
    scene_program_finish(&program);
    job_finish(&job);
}

// The number of waiting rays sizes an array, but not each depth has one of its own.
static void limits_of_paths_share_a_program(void **state)
{
    struct job_quality longer;
    struct job job;

    example_job_load(&job, "glass");
    job.quality = (struct job_quality){
        .method = JOB_METHOD_EQUIANGULAR, .points = 4, .samples = 1, .max_depth = 10, .min_throughput = 1e-3};
    longer = job.quality;
    longer.max_depth = 14;
    longer.min_throughput = 1e-5;
    assert_same_program(&job, &longer);
    job_finish(&job);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(settings_of_a_method_share_a_program),
        cmocka_unit_test(limits_of_paths_share_a_program),
        cmocka_unit_test(light_grids_share_a_program),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
