// Random scenes above order 1: random paths and grids of scattered light show what reference/ has, each to its noise.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/scene/light_rules.h"
#include "tests/support/bias_check.h"
#include "tests/support/random_job.h"
#include "tests/support/render_frame.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { TRUTH_PATHS = 2000, TRUTH_PATHS_MAX = 32 * TRUTH_PATHS, FRAMES = 16 };

// Every third scene has what paths alone show.
enum { SOLIDS_EVERY = 3 };

static const char PATHS[] = "{\"method\": \"paths\", \"paths\": 256}";
// The second has grids of twice the cells, and steps of half the length.
static const char *const GRIDS[] = {
    "{\"method\": \"cached\", \"step\": 0.04, \"light_grid\": 32, \"scatter_grid\": 10, \"paths\": 512}",
    "{\"method\": \"cached\", \"step\": 0.02, \"light_grid\": 64, \"scatter_grid\": 20, \"paths\": 1024}"};
// The noise of the truth, relative to its light, that is asked for, and the largest beside which a grid is judged:
// where media are thin, few of the reference's paths meet them.
static const double QUIET = 0.007, LOUD = 0.03;
// The error of the coarser that needs no second look, the share of it that the finer may have at most, and the largest.
static const double NEAR = 0.02, FALL = 0.75, FAR = 0.1;

struct sight {
    uint64_t seed;
    const char *volume;
    double light[BIAS_CHECK_VALUES], noise[BIAS_CHECK_VALUES]; // by reference/, with standard errors
};

static bool has_solids(uint64_t seed)
{
    return seed % SOLIDS_EVERY == 0;
}

static char *write_job(const struct sight *sight, const char *quality)
{
    return random_job_write(&(struct random_job){.volume = sight->volume,
                                                 .seed = sight->seed,
                                                 .quality = quality,
                                                 .width_px = BIAS_CHECK_WIDTH_PX,
                                                 .height_px = BIAS_CHECK_HEIGHT_PX,
                                                 .scatters = true,
                                                 .has_solids = has_solids(sight->seed)});
}

static void parse(struct job *job, const struct sight *sight, const char *quality)
{
    struct error error = {{0}};
    char *text = write_job(sight, quality);

    if (!job_parse(job, text, strlen(text), NULL, &error)) fail_msg("%s\n%s", error.message, text);
    job->output.pixel = JOB_PIXEL_FLOAT;
    free(text);
}

// The noise of the light, relative to it; 0 where all is black.
static double find_noise(const struct sight *sight)
{
    double own = 0.0, power = 0.0;

    for (size_t i = 0; i < BIAS_CHECK_VALUES; i++) {
        own += pow(sight->noise[i], 2);
        power += pow(sight->light[i], 2);
    }
    return power > 0.0 ? sqrt(own / power) : 0.0;
}

static bool is_black(const struct sight *sight)
{
    for (size_t i = 0; i < BIAS_CHECK_VALUES; i++)
        if (sight->light[i] > 0.0) return false;
    return true;
}

static void tell(const struct sight *sight, const struct job *job)
{
    print_message("scene %d: %d orders, %zu media, %zu objects, lights:", (int)sight->seed, job->scene.orders,
                  job->scene.medium_count, job->scene.object_count);
    for (size_t i = 0; i + 1 < job->scene.light_count; i++)
        print_message(" %s", light_rules_of(job->scene.lights[i].kind)->name);
    print_message("\n");
}

static void find_light(struct sight *sight)
{
    struct job job;

    parse(&job, sight, PATHS);
    tell(sight, &job);
    for (long count = TRUTH_PATHS; count <= TRUTH_PATHS_MAX; count *= 4) {
        bias_check_find_job_paths(&job, count, sight->light, sight->noise);
        if (find_noise(sight) <= QUIET) break;
    }
    job_finish(&job);
}

// True when the mean of many pictures is the light, pixel by pixel.
static bool is_fair(const struct sight *sight)
{
    struct bias_check_errors errors;
    struct job job;

    parse(&job, sight, PATHS);
    errors = bias_check_measure_job(&job, sight->light, sight->noise, FRAMES);
    job_finish(&job);
    print_message("scene %d: paths: off by %+.1e, %+.1f standard errors, chance %.2f, spread %.2f\n", (int)sight->seed,
                  errors.bias, errors.sigmas, errors.chance, errors.spread);
    // Few frames know their variance badly, and near lamps few of a pixel's values hold most of it.
    return fabs(errors.sigmas) < 4.5 && errors.chance < 2.5;
}

// The relative error without the noise of the truth.
static double find_error(const struct sight *sight, const char *quality)
{
    double square = 0.0, power = 0.0, own = find_noise(sight);
    struct image image;
    struct job job;

    parse(&job, sight, quality);
    render_frame_zero(&job, &image);
    for (size_t i = 0; i < BIAS_CHECK_VALUES; i++) {
        square += pow(image.rgba[i / 3 * 4 + i % 3] - sight->light[i], 2);
        power += pow(sight->light[i], 2);
    }
    image_finish(&image);
    job_finish(&job);
    return sqrt(fmax(square / power - own * own, 0.0));
}

// True when a grid shows the light, or a finer one shows it better.
static bool is_near(const struct sight *sight)
{
    double coarse = find_error(sight, GRIDS[0]), fine = coarse;

    if (coarse > NEAR) fine = find_error(sight, GRIDS[1]);
    print_message("scene %d: grids: error %.2f %%, then %.2f %%, beside noise of %.2f %%\n", (int)sight->seed,
                  100.0 * coarse, 100.0 * fine, 100.0 * find_noise(sight));
    return find_noise(sight) > LOUD || fine <= NEAR || (fine <= FALL * coarse && coarse <= FAR);
}

static int try_range(uint64_t first, uint64_t last, const char *volume)
{
    static struct sight sight;
    int wrong = 0;

    random_job_write_volume(volume);
    for (uint64_t seed = first; seed <= last; seed++) {
        sight.seed = seed;
        sight.volume = volume;
        find_light(&sight);
        if (is_black(&sight)) continue;
        if (!is_fair(&sight) || (!has_solids(seed) && !is_near(&sight))) {
            char *text = write_job(&sight, PATHS);

            print_message("scene %d: expected the light of reference/ in %s\n", (int)seed, text);
            free(text);
            wrong++;
        }
    }
    return wrong;
}

static void random_scenes_are_those_of_the_reference(void **state)
{
    const char *volume = temp_folder_path(state, "random.nrrd");

    assert_int_equal(try_range(3, 3, volume) + try_range(7, 7, volume), 0);
}

static uint64_t asked[2]; // seeds from the command line

static void scenes_asked_for_are_those_of_the_reference(void **state)
{
    assert_int_equal(try_range(asked[0], asked[1], temp_folder_path(state, "random.nrrd")), 0);
}

// Two arguments: the first and the last seed of the scenes.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(random_scenes_are_those_of_the_reference, temp_folder_create,
                                        temp_folder_destroy),
    };
    const struct CMUnitTest by_hand[] = {
        cmocka_unit_test_setup_teardown(scenes_asked_for_are_those_of_the_reference, temp_folder_create,
                                        temp_folder_destroy),
    };

    if (argc != 3) return cmocka_run_group_tests(tests, NULL, NULL);
    asked[0] = strtoull(argv[1], NULL, 10);
    asked[1] = strtoull(argv[2], NULL, 10);
    return cmocka_run_group_tests(by_hand, NULL, NULL);
}
