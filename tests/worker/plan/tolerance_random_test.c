// Random scenes and moments keep their tolerance, measured in every pixel.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "tests/support/gl_stage.h"
#include "tests/support/random_job.h"
#include "tests/support/temp_folder.h"
#include "tests/support/true_error.h"
#include "worker/picture/image.h"
#include "worker/plan/tolerance.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 16, HEIGHT_PX = 12, ASKED_WIDTH_PX = 48, ASKED_HEIGHT_PX = 27 };

struct outcome {
    int frames, seconds, within, beyond, refused;
    int unbounded; // whose true error is over the audit's bound
};

// The limits of an estimate: a frame may pass although its true error is over its tolerance, but rarely, and not by
// much.
static const double SLACK = 1.25;
// Of a bound that holds with the audit's confidence so many are exceeded.
static const double SHARE_BEYOND = 0.05;

static void try(struct tolerance *tolerance, const char *text, int64_t serial, double allowed, struct outcome *outcome)
{
    struct error error = {{0}};
    struct tolerance_result result;
    struct image image;
    struct job job;
    double truly;

    if (!job_parse(&job, text, strlen(text), NULL, &error)) fail_msg("%s\n%s", error.message, text);
    assert_true(image_init(&image, job.width_px, job.height_px, true, true, NULL));
    outcome->frames++;
    if (tolerance_render(tolerance,
                         &(struct tolerance_params){.job = &job, .serial = serial, .frame = 0, .image = &image},
                         &result, &error)) {
        truly = true_error_measure(&job, 0, &image);
        print_message("%d: tolerance %g: truly %.2e, audited %.2e (at most %.2e), %.1f %% traced, predicted by %s\n",
                      (int)serial, allowed, truly, result.audit.error, result.audit.error95,
                      100.0 * result.render.traced, result.reason);
        if (truly > SLACK * allowed) print_message("%s\n", text);
        outcome->beyond += truly > SLACK * allowed;
        outcome->within += truly <= allowed;
        outcome->unbounded += truly > result.audit.error95;
        outcome->seconds += result.retry_count > 0;
    } else {
        print_message("%d: %s\n", (int)serial, error.message);
        assert_int_equal(result.render.fault, RENDERER_FAULT_MISSED);
        outcome->refused++;
    }
    fflush(stdout);
    image_finish(&image);
    job_finish(&job);
}

// Seeds, and whether each scene is tried with every tolerance or with one of them.
struct range {
    uint64_t first, last;
    bool is_thorough;
    int width_px, height_px;
};

static struct outcome try_range(const struct range *range, const char *volume)
{
    static const double tolerances[] = {0.1, 0.03, 0.01};
    struct gl_stage stage = gl_stage_open(GL_BACKEND_SOFTWARE, NULL);
    struct tolerance *tolerance;
    struct outcome outcome = {0};
    int64_t serial = 0;

    tolerance = tolerance_create(stage.renderer);
    random_job_write_volume(volume);
    for (uint64_t seed = range->first; seed <= range->last; seed++)
        for (uint64_t i = 0; i < 3; i++) {
            char quality[64], *text;

            if (!range->is_thorough && i != seed % 3) continue;
            snprintf(quality, sizeof quality, "{\"tolerance\": %g}", tolerances[i]);
            text = random_job_write(&(struct random_job){.volume = volume,
                                                         .seed = seed,
                                                         .quality = quality,
                                                         .width_px = range->width_px,
                                                         .height_px = range->height_px});
            print_message("seed %d, ", (int)seed);
            try(tolerance, text, ++serial, tolerances[i], &outcome);
            free(text);
        }
    tolerance_destroy(tolerance);
    gl_stage_close(stage);
    print_message("of %d frames %d are within, %d are beyond by a quarter, %d were rendered twice, %d given up\n",
                  outcome.frames, outcome.within, outcome.beyond, outcome.seconds, outcome.refused);
    return outcome;
}

static void random_scenes_keep_their_tolerance(void **state)
{
    struct outcome outcome =
        try_range(&(struct range){101, 108, false, WIDTH_PX, HEIGHT_PX}, temp_folder_path(state, "random.nrrd"));

    assert_int_equal(outcome.refused + outcome.beyond, 0);
    assert_true(outcome.within >= outcome.frames - 1);
}

// Held out: no constant is chosen by them. If one of these fails, the method is corrected by means of other scenes.
static void scenes_held_out_keep_their_tolerance(void **state)
{
    struct outcome outcome =
        try_range(&(struct range){7001, 7003, false, WIDTH_PX, HEIGHT_PX}, temp_folder_path(state, "random.nrrd"));

    assert_int_equal(outcome.refused + outcome.beyond, 0);
    assert_true(outcome.within >= outcome.frames - 1);
}

static struct range asked; // seeds from the command line

// The least number that more than so many of `count` frames exceed in one of forty draws only, if each is beyond with
// the probability SHARE_BEYOND: sums of the binomial distribution.
static int most_by_chance(int count)
{
    double probability = pow(1.0 - SHARE_BEYOND, count), sum = probability;
    int most = 0;

    while (sum < 0.975) {
        probability *= (count - most) / (most + 1.0) * SHARE_BEYOND / (1.0 - SHARE_BEYOND);
        sum += probability;
        most++;
    }
    return most;
}

static void scenes_that_were_asked_for_keep_their_tolerance(void **state)
{
    struct outcome outcome = try_range(&asked, temp_folder_path(state, "random.nrrd"));
    int published = outcome.frames - outcome.refused, over = published - outcome.within;
    int allowed = most_by_chance(published);

    print_message("of %d frames published %d are over their tolerance and %d over their bound; "
                  "a confidence of 95 %% allows %d of either\n",
                  published, over, outcome.unbounded, allowed);
    assert_true(over <= allowed);
    assert_true(outcome.unbounded <= allowed);
}

// Two arguments: the first and the last seed of scenes to try, each with every tolerance, in larger pictures. Two more:
// the pictures' width and height; those of 128 pixels a side and more have interpolated pixels.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(random_scenes_keep_their_tolerance, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(scenes_held_out_keep_their_tolerance, temp_folder_create, temp_folder_destroy),
    };
    const struct CMUnitTest by_hand[] = {
        cmocka_unit_test_setup_teardown(scenes_that_were_asked_for_keep_their_tolerance, temp_folder_create,
                                        temp_folder_destroy),
    };

    if (argc != 3 && argc != 5) return cmocka_run_group_tests(tests, NULL, NULL);
    asked =
        (struct range){strtoull(argv[1], NULL, 10), strtoull(argv[2], NULL, 10), true, ASKED_WIDTH_PX, ASKED_HEIGHT_PX};
    if (argc == 5) {
        asked.width_px = (int)strtol(argv[3], NULL, 10);
        asked.height_px = (int)strtol(argv[4], NULL, 10);
    }
    return cmocka_run_group_tests(by_hand, NULL, NULL);
}
