// How often the bound on what is left out holds, for paths that find it often and seldom, and far from evenly.
// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/beyond_estimate.h"

#include "reference/stream.h"
#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

enum { HALF = 8, TRIALS = 400, PIXELS_MOST = 1024 };

static double draw_normal(struct stream *stream)
{
    double radius = sqrt(-2.0 * log1p(-stream_draw(stream)));

    return radius * cos(2.0 * M_PI * stream_draw(stream));
}

// A picture whose pixels have light of all sizes, a third none. Each path brings light of one scattering, and with a
// probability that differs between pixels light of more.
struct picture {
    double chance; // in the mean
    double spread; // of a path's light beyond, about its mean: the logarithm's standard deviation
    int pixels;    // that are drawn
};

struct pixel {
    double light, chance;
};

static struct pixel draw_pixel(const struct picture *picture, struct stream *stream)
{
    struct pixel pixel = {.light = stream_draw(stream) < 0.67 ? exp(0.8 * draw_normal(stream)) : 0.0};

    pixel.chance = fmin(picture->chance * (0.4 + 1.2 * stream_draw(stream)), 1.0);
    return pixel;
}

static void draw_half(const struct picture *picture, const struct pixel *pixel, struct stream *stream, double *beyond,
                      double *whole)
{
    double more = 0.0, first = 0.0;

    for (int i = 0; i < HALF; i++) {
        first -= log1p(-stream_draw(stream));
        if (stream_draw(stream) < pixel->chance)
            more += exp(picture->spread * draw_normal(stream) - 0.5 * picture->spread * picture->spread);
    }
    *beyond = pixel->light * more / HALF;
    *whole = pixel->light * (first + more) / HALF;
}

static struct beyond_verdict measure(const struct picture *picture, struct stream *stream)
{
    static struct beyond_sample samples[PIXELS_MOST];

    for (int i = 0; i < picture->pixels; i++) {
        struct pixel pixel = draw_pixel(picture, stream);
        double beyond[2], whole[2];

        for (int k = 0; k < 2; k++)
            draw_half(picture, &pixel, stream, &beyond[k], &whole[k]);
        samples[i] = (struct beyond_sample){.product = beyond[0] * beyond[1],
                                            .square = 0.25 * (beyond[0] + beyond[1]) * (beyond[0] + beyond[1]),
                                            .whole = whole[0] * whole[1]};
    }
    return beyond_estimate(samples, (size_t)picture->pixels, 2 * HALF);
}

// Light and chance are independent: the mean squares of a chance that is even from 0.4 to 1.6 times its mean.
static double truth_of(const struct picture *picture)
{
    double mean = picture->chance, square = mean * mean * (1.0 + 1.2 * 1.2 / 12.0);

    return sqrt(square / (1.0 + 2.0 * mean + square));
}

static void check(const struct picture *picture, double width_most)
{
    double truth = truth_of(picture), sum = 0.0, bounds = 0.0;
    struct stream stream = stream_of(3, (uint64_t)picture->pixels);
    int held = 0;

    for (int i = 0; i < TRIALS; i++) {
        struct beyond_verdict verdict = measure(picture, &stream);

        held += verdict.error95 >= truth;
        sum += verdict.error * verdict.error / TRIALS;
        bounds += verdict.error95 / TRIALS;
        assert_true(verdict.error <= verdict.error95);
    }
    printf("left out %.2g by %d pixels: RMS of the errors %.3g, mean bound %.3g, held in %.1f %%\n", truth,
           picture->pixels, sqrt(sum), bounds, 100.0 * held / TRIALS);
    assert_true(held >= 0.93 * TRIALS);
    assert_true(bounds <= width_most);
}

static void the_bound_holds_where_much_is_left_out(void **state)
{
    check(&(struct picture){0.6, 0.5, 64}, 0.65);
    check(&(struct picture){0.6, 0.5, 1024}, 0.5);
    check(&(struct picture){0.6, 1.5, 64}, 1.0);
    check(&(struct picture){0.6, 1.5, 1024}, 0.6);
    check(&(struct picture){0.2, 0.5, 256}, 0.35);
    check(&(struct picture){0.1, 1.5, 256}, 0.5);
    check(&(struct picture){0.1, 1.0, 1024}, 0.2);
}

static void the_bound_holds_where_little_is_left_out(void **state)
{
    check(&(struct picture){0.05, 1.5, 64}, 0.4);
    check(&(struct picture){0.05, 1.5, 1024}, 0.4);
    check(&(struct picture){0.02, 0.5, 256}, 0.1);
    check(&(struct picture){0.02, 1.5, 1024}, 0.3);
    check(&(struct picture){0.002, 0.5, 1024}, 0.05);
    check(&(struct picture){0.0002, 0.5, 1024}, 0.02);
    check(&(struct picture){0.00002, 0.5, 1024}, 0.01);
    check(&(struct picture){0.0002, 0.5, 64}, 0.02);
}

// The paths of one half are those of the other: their product has their noise.
static void halves_that_are_not_independent_are_noticed(void **state)
{
    const struct picture picture = {0.02, 0.5, 1024};
    struct stream stream = stream_of(5, 0);
    double honest = 0.0, noisy = 0.0;

    for (int i = 0; i < TRIALS; i++) {
        static struct beyond_sample samples[PIXELS_MOST];

        for (int k = 0; k < picture.pixels; k++) {
            struct pixel pixel = draw_pixel(&picture, &stream);
            double beyond, whole;

            draw_half(&picture, &pixel, &stream, &beyond, &whole);
            samples[k] = (struct beyond_sample){beyond * beyond, beyond * beyond, whole * whole};
        }
        noisy += pow(beyond_estimate(samples, PIXELS_MOST, HALF).error, 2.0) / TRIALS;
        honest += pow(measure(&picture, &stream).error, 2.0) / TRIALS;
    }
    assert_near(sqrt(honest), truth_of(&picture), 0.1 * truth_of(&picture));
    assert_true(sqrt(noisy) > 1.5 * truth_of(&picture));
}

static void a_ratio_far_above_one_says_nothing(void **state)
{
    struct beyond_sample samples[64] = {{0}};

    for (int i = 0; i < 64; i++)
        samples[i] = (struct beyond_sample){1.0, 1.0, 1.0};
    assert_false(beyond_estimate(samples, 64, 16).is_noisy);
    assert_true(beyond_estimate(samples, 64, 16).error == 1.0);
    samples[0].product = 30.0;
    assert_true(beyond_estimate(samples, 64, 16).is_noisy);
}

static void a_black_picture_has_no_error(void **state)
{
    const struct beyond_sample black[4] = {{0}};

    assert_true(isnan(beyond_estimate(black, 4, 16).error));
    assert_true(isnan(beyond_estimate(black, 0, 16).error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_bound_holds_where_much_is_left_out),
        cmocka_unit_test(the_bound_holds_where_little_is_left_out),
        cmocka_unit_test(halves_that_are_not_independent_are_noticed),
        cmocka_unit_test(a_ratio_far_above_one_says_nothing),
        cmocka_unit_test(a_black_picture_has_no_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
