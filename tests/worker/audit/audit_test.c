// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/audit.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/assert_near.h"
#include "tests/support/example_job.h"
#include "tests/support/render_frame.h"
#include "worker/audit/audit_map.h"
#include "worker/audit/audit_random.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WIDTH_PX = 40, HEIGHT_PX = 30, PIXELS = WIDTH_PX * HEIGHT_PX, SMALL_WIDTH_PX = 8, SMALL_HEIGHT_PX = 6 };

static struct image make_image(int width_px, int height_px, float value)
{
    struct image image;

    assert_true(image_init(&image, width_px, height_px, false, false, NULL));
    for (int i = 0; i < 4 * width_px * height_px; i++)
        image.rgba[i] = value;
    return image;
}

static void put(struct image *image, int x, int y, float value)
{
    for (int c = 0; c < 3; c++)
        image->rgba[4 * (y * image->width_px + x) + c] = value;
}

// A picture with one bright pixel and some that lost light with cut rays, and two small renders that differ in one
// pixel.
struct scenery {
    struct image image, finer, coarser;
    struct audit_map map;
};

static void set_scenery(struct scenery *scenery)
{
    scenery->image = make_image(WIDTH_PX, HEIGHT_PX, 0.5f);
    scenery->finer = make_image(SMALL_WIDTH_PX, SMALL_HEIGHT_PX, 0.5f);
    scenery->coarser = make_image(SMALL_WIDTH_PX, SMALL_HEIGHT_PX, 0.5f);
    put(&scenery->image, 7, 21, 4.0f);
    put(&scenery->coarser, 5, 2, 0.7f);
    assert_true(image_ask_cut(&scenery->image, NULL));
    for (int i = 0; i < PIXELS; i++)
        scenery->image.cut[i] = i / WIDTH_PX == 12 && i % WIDTH_PX < 8 ? 0.1f * (float)(i % WIDTH_PX) : 0.0f;
    audit_map_init(&scenery->map, &(struct audit_map_params){.image = &scenery->image,
                                                             .pixel = JOB_PIXEL_HALF,
                                                             .finer = &scenery->finer,
                                                             .coarser = &scenery->coarser,
                                                             .is_own = true});
}

static void clear_scenery(struct scenery *scenery)
{
    audit_map_finish(&scenery->map);
    image_finish(&scenery->image);
    image_finish(&scenery->finer);
    image_finish(&scenery->coarser);
}

static void densities_are_probabilities(void **state)
{
    struct scenery scenery;
    double sum = 0.0, least = INFINITY;

    set_scenery(&scenery);
    for (int i = 0; i < PIXELS; i++) {
        double density = audit_map_density(&scenery.map, (struct pixel){i % WIDTH_PX, i / WIDTH_PX});

        sum += density / PIXELS;
        least = fmin(least, density);
    }
    assert_near(sum, 1.0, 1e-9);
    assert_true(least >= 0.25 / 1.15);
    clear_scenery(&scenery);
}

// Weights are right only if pixels are drawn as often as their density says.
static void draws_follow_densities(void **state)
{
    enum { DRAWS = 200000 };
    struct pixel *points = calloc(DRAWS, sizeof *points);
    double *counts = calloc(PIXELS, sizeof *counts), worst = 0.0;
    struct job job = {.hash = "0123"};
    struct scenery scenery;

    set_scenery(&scenery);
    audit_map_draw(&scenery.map, &job, 3, 0, DRAWS, points);
    for (int i = 0; i < DRAWS; i++) {
        assert_in_range(points[i].x, 0, WIDTH_PX - 1);
        assert_in_range(points[i].y, 0, HEIGHT_PX - 1);
        counts[points[i].y * WIDTH_PX + points[i].x]++;
    }
    for (int i = 0; i < PIXELS; i++) {
        struct pixel place = {i % WIDTH_PX, i / WIDTH_PX};
        double wanted = DRAWS * audit_map_density(&scenery.map, place) / PIXELS;

        worst = fmax(worst, fabs(counts[i] - wanted) / sqrt(wanted));
    }
    // In standard errors: one of 1200 counts is 5 off by chance once in 1500 runs, and the seed is fixed.
    print_message("the count farthest off its density is %.1f standard errors off\n", worst);
    assert_true(worst < 5.0);
    clear_scenery(&scenery);
    free(points);
    free(counts);
}

static void draws_are_the_jobs_and_the_frames(void **state)
{
    enum { DRAWS = 50 };
    struct pixel points[DRAWS], again[DRAWS], later[DRAWS / 2], other[DRAWS];
    struct job job = {.hash = "0123"}, other_job = {.hash = "0124"};
    struct scenery scenery;

    set_scenery(&scenery);
    audit_map_draw(&scenery.map, &job, 3, 0, DRAWS, points);
    audit_map_draw(&scenery.map, &job, 3, 0, DRAWS, again);
    audit_map_draw(&scenery.map, &job, 3, DRAWS / 2, DRAWS / 2, later);
    assert_memory_equal(points, again, sizeof points);
    assert_memory_equal(points + DRAWS / 2, later, sizeof later);
    audit_map_draw(&scenery.map, &job, 4, 0, DRAWS, other);
    assert_memory_not_equal(points, other, sizeof points);
    audit_map_draw(&scenery.map, &other_job, 3, 0, DRAWS, other);
    assert_memory_not_equal(points, other, sizeof points);
    clear_scenery(&scenery);
}

static void pixels_that_stand_out_are_drawn_more(void **state)
{
    struct scenery scenery;
    double plain, spike, change, cut;

    set_scenery(&scenery);
    plain = audit_map_density(&scenery.map, (struct pixel){35, 2});
    spike = audit_map_density(&scenery.map, (struct pixel){7, 21});
    change = audit_map_density(&scenery.map, (struct pixel){27, 12});
    cut = audit_map_density(&scenery.map, (struct pixel){7, 12});
    assert_true(spike > 50.0 * plain);
    assert_true(change > 5.0 * plain);
    assert_true(cut > 50.0 * plain);
    clear_scenery(&scenery);
}

static struct truth_pixel light_of(double value)
{
    return (struct truth_pixel){.rgb = {value, value, value}, .is_converged = true};
}

static void compare_points(const struct audit_map *map, const struct pixel *points, size_t count, double value,
                           struct audit_samples *samples)
{
    struct truth_pixel light = light_of(value);

    for (size_t i = 0; i < count; i++) {
        struct audit_sample sample = audit_map_compare(map, points[i], NULL, &light);

        audit_samples_append(samples, &sample);
    }
}

// The light is 0.5 everywhere; the one bright pixel is all of the error.
static void the_mean_of_many_audits_is_the_error(void **state)
{
    enum { AUDITS = 400, RAYS = 64 };
    double squares = 0.0, wanted = 3.5 * 3.5 / PIXELS;
    struct job job = {.hash = "0123"};
    struct scenery scenery;

    set_scenery(&scenery);
    for (int i = 0; i < AUDITS; i++) {
        struct audit_samples samples = {0};
        struct pixel points[RAYS];

        audit_map_draw(&scenery.map, &job, i, 0, RAYS, points);
        compare_points(&scenery.map, points, RAYS, 0.5, &samples);
        for (size_t k = 0; k < RAYS; k++)
            squares += samples.list[k].square * scenery.map.mean_square / (AUDITS * RAYS);
        audit_samples_finish(&samples);
    }
    // 25,600 draws, of which every tenth or so is the bright pixel.
    assert_near(squares, wanted, 0.05 * wanted);
    clear_scenery(&scenery);
}

// Each half of the reference errs by 0.5, as much as the light: the frame's own error of 0.05 is found all the same.
static void noise_of_the_reference_counts_nothing(void **state)
{
    enum { DRAWS = 100000 };
    const struct pixel point = {35, 2};
    uint64_t random = 7;
    double sum = 0.0, weight;
    struct scenery scenery;

    set_scenery(&scenery);
    weight = 1.0 / (audit_map_density(&scenery.map, point) * scenery.map.mean_square);
    for (int i = 0; i < DRAWS; i++) {
        struct truth_pixel light = light_of(0.0);

        for (int c = 0; c < 3; c++) {
            double first = 0.45 + (audit_random(&random) < 0.5 ? -0.5 : 0.5);
            double second = 0.45 + (audit_random(&random) < 0.5 ? -0.5 : 0.5);

            light.rgb[c] = 0.5 * (first + second);
            light.half[c] = 0.5 * (first - second);
        }
        sum += audit_map_compare(&scenery.map, point, NULL, &light).square / (weight * DRAWS);
    }
    assert_near(sum, 0.05 * 0.05, 0.002);
    clear_scenery(&scenery);
}

// The example fog at one moment, with another quality than its job's.
struct shot {
    struct job job;
    struct image image;
    struct truth *truth;
};

static void take_shot(struct shot *shot, int points)
{
    struct error error = {{0}};

    example_job_load(&shot->job, "fog");
    example_job_shrink(&shot->job, 64, 36, 1.4);
    shot->job.quality.points = points;
    render_frame_zero(&shot->job, &shot->image);
    shot->truth = truth_open(&(struct truth_params){.job = &shot->job}, &error);
    if (!shot->truth) fail_msg("%s", error.message);
}

static void finish_shot(struct shot *shot)
{
    truth_close(shot->truth);
    image_finish(&shot->image);
    job_finish(&shot->job);
}

static struct audit_params params_of(const struct shot *shot)
{
    return (struct audit_params){.job = &shot->job, .image = &shot->image, .truth = shot->truth, .tolerance = 0.01};
}

static void a_good_frame_is_within_and_a_coarse_one_is_not(void **state)
{
    struct audit_result result;
    struct audit_params params;
    struct shot good, coarse;

    take_shot(&good, 32);
    params = params_of(&good);
    assert_true(audit_frame(&params, &result));
    assert_int_equal(result.kind, AUDIT_REFERENCE);
    assert_false(result.is_pooled);
    assert_true(result.error95 <= 0.01 && result.error <= result.error95);
    assert_in_range(result.ray_count, AUDIT_RAYS_MIN, 4 * AUDIT_RAYS_MIN);
    assert_true(result.tolerance == 0.01);
    assert_true(result.sampling_error == 0.0);
    finish_shot(&good);
    take_shot(&coarse, 1);
    params = params_of(&coarse);
    assert_true(audit_frame(&params, &result));
    assert_true(result.error > 0.02);
    assert_int_equal(result.ray_count, AUDIT_RAYS_MIN); // it is clear that it misses
    finish_shot(&coarse);
}

static void the_most_pixels_end_an_audit(void **state)
{
    struct audit_result result;
    struct audit_params params;
    struct shot shot;
    double error;

    take_shot(&shot, 32);
    params = params_of(&shot);
    assert_true(audit_frame(&params, &result));
    error = result.error;
    // A tolerance at which it stays open for long on which side it is.
    for (int i = 0; i < 40 && result.ray_count <= 4 * AUDIT_RAYS_MIN; i++) {
        params.tolerance = error * (0.6 + 0.02 * i);
        assert_true(audit_frame(&params, &result));
    }
    print_message("error %.2e, at most %.2e by %d rays\n", result.error, result.error95, result.ray_count);
    assert_true(result.ray_count > 4 * AUDIT_RAYS_MIN);
    // A picture that can be replaced is given up sooner, and sooner yet where its error is over the tolerance.
    params.is_replaceable = true;
    assert_true(audit_frame(&params, &result));
    print_message("replaceable: error %.2e by %d rays\n", result.error, result.ray_count);
    assert_int_equal(result.ray_count, result.error > params.tolerance ? 2 * AUDIT_RAYS_MIN : 4 * AUDIT_RAYS_MIN);
    params.ray_max = AUDIT_RAYS_MIN;
    assert_true(audit_frame(&params, &result));
    assert_int_equal(result.ray_count, AUDIT_RAYS_MIN);
    finish_shot(&shot);
}

// Interpolated pixels may leave it open whether the whole frame is within, however exact those are that are traced.
static void interpolation_leaves_it_open(void **state)
{
    struct audit_result result;
    struct audit_params params;
    struct shot shot;

    take_shot(&shot, 32);
    params = params_of(&shot);
    params.interpolation = (struct audit_verdict){.error = 0.001, .spread = 0.0001};
    assert_true(audit_frame(&params, &result));
    assert_int_equal(result.ray_count, AUDIT_RAYS_MIN);
    params.interpolation = (struct audit_verdict){.error = 0.0099, .spread = 0.002};
    assert_true(audit_frame(&params, &result));
    assert_true(result.ray_count > AUDIT_RAYS_MIN);
    finish_shot(&shot);
    (void)state;
}

static bool count_shares(void *calls, double done)
{
    double measured = ++*(int *)calls;

    return done == measured / (measured + 0.25 * AUDIT_RAYS_MIN);
}

static void an_audit_tells_how_much_it_has_measured(void **state)
{
    struct audit_result result;
    struct audit_params params;
    struct shot shot;
    int calls = 0;

    take_shot(&shot, 1);
    params = params_of(&shot);
    params.thread_count = 1; // pixels of other threads are told once the batch is measured
    params.on_progress = count_shares;
    params.user = &calls;
    assert_true(audit_frame(&params, &result));
    assert_int_equal(calls, AUDIT_RAYS_MIN);
    finish_shot(&shot);
}

static bool stop_at_once(void *calls, double done)
{
    (void)done;
    ++*(int *)calls;
    return false;
}

static void an_audit_can_be_stopped(void **state)
{
    struct audit_result result;
    struct audit_params params;
    struct shot shot;
    int calls = 0;

    take_shot(&shot, 32);
    params = params_of(&shot);
    params.on_progress = stop_at_once;
    params.user = &calls;
    params.thread_count = 1; // other threads could measure all pixels before this one asks
    assert_false(audit_frame(&params, &result));
    assert_int_equal(calls, 1);
    finish_shot(&shot);
}

static void few_pixels_are_enough_with_a_pool(void **state)
{
    struct audit_pool pool = {0};
    struct audit_result result;
    struct audit_params params;
    struct shot shot;

    take_shot(&shot, 32);
    params = params_of(&shot);
    params.gathered = &pool;
    assert_true(audit_frame(&params, &result));
    assert_int_equal(pool.samples.count, result.ray_count);
    params = params_of(&shot);
    params.frame = 1; // draws other pixels
    params.pool = &pool;
    assert_true(audit_frame(&params, &result));
    assert_true(result.is_pooled);
    assert_int_equal(result.ray_count, pool.samples.count + AUDIT_RAYS_POOLED);
    // The frame is broken, its pool is not.
    for (int i = 0; i < 64 * 36 * 4; i++)
        shot.image.rgba[i] *= 1.2f;
    assert_true(audit_frame(&params, &result));
    assert_false(result.is_pooled);
    assert_true(result.error95 > 0.1);
    finish_shot(&shot);
    audit_pool_finish(&pool);
}

static void a_spoilt_frame_has_no_finite_error(void **state)
{
    struct audit_result result;
    struct audit_params params;
    struct shot shot;

    take_shot(&shot, 32);
    shot.image.rgba[4 * 100] = NAN;
    params = params_of(&shot);
    assert_true(audit_frame(&params, &result));
    assert_true(isinf(result.error95));
    finish_shot(&shot);
}

// Two good pictures of rough surfaces still differ by their random normals.
static void noise_of_rough_surfaces_is_no_error(void **state)
{
    struct audit_result result;
    struct audit_params params;
    struct error error = {{0}};
    double rmse = 0.0, square = 0.0, noise = 0.0;
    struct truth *truth;
    struct image image;
    struct job job;

    example_job_load(&job, "mirror");
    example_job_shrink(&job, 48, 27, 2.5);
    job.quality.samples = 16;
    memcpy(job.hash, "0123", sizeof "0123"); // else the drawn pixels depend on the folder of the job
    render_frame_zero(&job, &image);
    truth = truth_open(&(struct truth_params){.job = &job}, &error);
    if (!truth) fail_msg("%s", error.message);
    for (int i = 0; i < 48 * 27; i++) {
        struct truth_pixel pixel = truth_measure(truth, i % 48, i / 48, NULL);

        for (int c = 0; c < 3; c++) {
            rmse += (image.rgba[4 * i + c] - pixel.rgb[c]) * (image.rgba[4 * i + c] - pixel.rgb[c]);
            square += pixel.rgb[c] * pixel.rgb[c];
            noise += (1.0 + pixel.share) * pixel.variance[c];
        }
    }
    noise = sqrt(noise / square);
    rmse = sqrt(rmse / square);
    params = (struct audit_params){
        .job = &job, .image = &image, .truth = truth, .tolerance = 1e-3, .ray_min = 512, .ray_max = 512};
    assert_true(audit_frame(&params, &result));
    print_message("difference %.2e, noise %.2e; audited: error %.2e, at most %.2e, noise %.2e\n", rmse, noise,
                  result.error, result.error95, result.sampling_error);
    assert_near(rmse, noise, 0.2 * noise);
    assert_near(result.sampling_error, noise / sqrt(1.25), 0.2 * noise);
    assert_true(result.error95 < 0.5 * noise);
    // A picture that is ten per cent too bright differs by more than noise.
    for (int i = 0; i < 48 * 27 * 4; i++)
        image.rgba[i] *= 1.1f;
    assert_true(audit_frame(&params, &result));
    assert_true(result.error95 >= 0.1);
    truth_close(truth);
    image_finish(&image);
    job_finish(&job);
}

int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(densities_are_probabilities),
        cmocka_unit_test(draws_follow_densities),
        cmocka_unit_test(draws_are_the_jobs_and_the_frames),
        cmocka_unit_test(pixels_that_stand_out_are_drawn_more),
        cmocka_unit_test(the_mean_of_many_audits_is_the_error),
        cmocka_unit_test(noise_of_the_reference_counts_nothing),
        cmocka_unit_test(a_good_frame_is_within_and_a_coarse_one_is_not),
        cmocka_unit_test(the_most_pixels_end_an_audit),
        cmocka_unit_test(interpolation_leaves_it_open),
        cmocka_unit_test(an_audit_tells_how_much_it_has_measured),
        cmocka_unit_test(an_audit_can_be_stopped),
        cmocka_unit_test(few_pixels_are_enough_with_a_pool),
        cmocka_unit_test(a_spoilt_frame_has_no_finite_error),
        cmocka_unit_test(noise_of_rough_surfaces_is_no_error),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
