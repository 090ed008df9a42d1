// SPDX-License-Identifier: Apache-2.0
#include "reference/density_noise.h"

#include "reference/density_bounded.h"
#include "tests/support/assert_near.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const struct density_noise_params ONE_OCTAVE = {
    .octaves = 1,
    .mode = SCENE_NOISE_CLIP,
    .frequency = 1.0,
    .lacunarity = 2.0,
    .hurst = 1.0,
    .axis = {0.0, 1.0, 0.0},
    .scale = 1.0,
};

static struct vec3 random_point(struct random *random, double half_size)
{
    struct vec3 point;

    point.x = random_between(random, -half_size, half_size);
    point.y = random_between(random, -half_size, half_size);
    point.z = random_between(random, -half_size, half_size);
    return point;
}

// A point with 20 bits of fraction, so that its sums with whole numbers are exact.
static struct vec3 random_exact_point(struct random *random, double half_size)
{
    struct vec3 point = vec3_scale(random_point(random, half_size), 0x1p20);

    return vec3_scale((struct vec3){round(point.x), round(point.y), round(point.z)}, 0x1p-20);
}

static double density_of(const struct density_noise_params *params, struct vec3 position)
{
    struct density_noise noise;

    density_noise_init(&noise, params);
    return density_noise(&noise, position);
}

// The value is the one that Perlin's own program prints at this point, as quoted wherever it was ported.
static void noise_has_the_published_value(void **state)
{
    // The sums are in another order: four units in the last place.
    assert_near(density_noise_octave((struct vec3){3.14, 42.0, 7.0}), 0.13691995878400012, 4.0 * 0x1p-55);
}

static void noise_is_zero_at_every_lattice_point(void **state)
{
    struct random random = {1};

    for (int i = 0; i < 2000; i++) {
        struct vec3 point = random_point(&random, i % 2 ? 1e15 : 300.0);

        assert_true(density_noise_octave((struct vec3){floor(point.x), floor(point.y), floor(point.z)}) == 0.0);
    }
    assert_true(density_noise_octave((struct vec3){-1e300, 1e300, 1e19}) == 0.0);
}

// Two components of a gradient are 1 or -1, the third is 0: the direction to the middle of a cube's edge.
static void slope_at_a_lattice_point_is_its_gradient(void **state)
{
    const double h = 1e-4;
    struct random random = {2};

    for (int i = 0; i < 500; i++) {
        struct vec3 point = random_point(&random, 200.0);
        double x = floor(point.x), y = floor(point.y), z = floor(point.z);
        double slope[3], square = 0.0;

        slope[0] =
            (density_noise_octave((struct vec3){x + h, y, z}) - density_noise_octave((struct vec3){x - h, y, z})) /
            (2.0 * h);
        slope[1] =
            (density_noise_octave((struct vec3){x, y + h, z}) - density_noise_octave((struct vec3){x, y - h, z})) /
            (2.0 * h);
        slope[2] =
            (density_noise_octave((struct vec3){x, y, z + h}) - density_noise_octave((struct vec3){x, y, z - h})) /
            (2.0 * h);
        for (int c = 0; c < 3; c++) {
            // The ramps of the neighbours, whose values differ by up to 2, add up to 10 h^3.
            assert_near(slope[c], round(slope[c]), 20.0 * h * h);
            square += round(slope[c]) * round(slope[c]);
        }
        assert_true(square == 2.0);
    }
}

static void noise_repeats_after_256_cells_along_each_axis(void **state)
{
    static const struct vec3 PERIODS[] = {{256.0, 0.0, 0.0}, {0.0, 256.0, 0.0}, {0.0, 0.0, 256.0}};
    struct random random = {3};
    int other = 0;

    for (int i = 0; i < 500; i++) {
        struct vec3 point = random_exact_point(&random, 300.0);
        double wanted = density_noise_octave(point);

        for (int axis = 0; axis < 3; axis++) {
            struct vec3 half = vec3_scale(PERIODS[axis], 0.5);

            assert_true(density_noise_octave(vec3_add(point, PERIODS[axis])) == wanted);
            assert_true(density_noise_octave(vec3_subtract(point, vec3_scale(PERIODS[axis], 3.0))) == wanted);
            other += density_noise_octave(vec3_add(point, half)) != wanted;
        }
    }
    assert_true(other > 1400); // half of it is no period
}

// Interpolation weights are quintic: slope and curvature are continuous from one cell to the next.
static void slope_and_curvature_are_continuous_between_cells(void **state)
{
    const double h = 1e-3;
    struct random random = {4};

    for (int i = 0; i < 500; i++) {
        struct vec3 point = random_point(&random, 200.0), step = {h, 0.0, 0.0};
        double middle, sides[4], before, after;

        point.x = floor(point.x);
        middle = density_noise_octave(point);
        for (int k = 0; k < 4; k++)
            sides[k] = density_noise_octave(vec3_add(point, vec3_scale(step, k < 2 ? k - 2 : k - 1)));
        before = (middle - 2.0 * sides[1] + sides[0]) / (h * h);
        after = (sides[3] - 2.0 * sides[2] + middle) / (h * h);
        // Third derivatives reach a few hundred; the second differences are 2 h apart.
        assert_near(after, before, 1.0);
        assert_near((sides[2] - middle) / h, (middle - sides[1]) / h, 0.05);
    }
}

static void noise_keeps_its_range_and_its_mean(void **state)
{
    enum { COUNT = 100000 };
    struct random random = {5};
    double sum = 0.0, squares = 0.0, largest = 0.0;

    for (int i = 0; i < COUNT; i++) {
        double value = density_noise_octave(random_point(&random, 128.0));

        sum += value;
        squares += value * value;
        largest = fmax(largest, fabs(value));
    }
    // The value is at most 1.0364, where eight ramps all rise towards one point.
    assert_true(largest < 1.0364);
    assert_true(largest > 0.75);
    // The ramp is odd about each lattice point and its weight is even, so that the mean is 0. Four standard errors.
    assert_near(sum / COUNT, 0.0, 4.0 * sqrt(squares / COUNT / COUNT));
}

static void octaves_add_by_lacunarity_and_h(void **state)
{
    struct random random = {6};
    struct density_noise_params params = ONE_OCTAVE;

    params.octaves = 3;
    params.lacunarity = 1.7;
    params.hurst = 0.6;
    params.frequency = 2.5;
    params.scale = 4.0;
    for (int i = 0; i < 500; i++) {
        struct vec3 point = random_point(&random, 5.0), q = vec3_scale(point, 2.5);
        double first = density_noise_octave(q), second = density_noise_octave(vec3_scale(q, 1.7)),
               third = density_noise_octave(vec3_scale(q, 1.7 * 1.7)), gain = pow(1.7, -0.6);
        double sum = first + gain * second + gain * gain * third;

        // 1e-12: roundings of a few hundred operations on numbers up to 40.
        params.mode = SCENE_NOISE_CLIP;
        assert_near(density_of(&params, point), 4.0 * fmax(sum, 0.0), 1e-12);
        params.mode = SCENE_NOISE_REMAP;
        assert_near(density_of(&params, point), 4.0 * fmax((1.0 + sum) / 2.0, 0.0), 1e-12);
        params.mode = SCENE_NOISE_ABSOLUTE;
        assert_near(density_of(&params, point), 4.0 * (fabs(first) + gain * fabs(second) + gain * gain * fabs(third)),
                    1e-12);
    }
}

// Finds a point where one octave is a quarter, so that four equal octaves are 1, between a lattice point and one of
// more.
static struct vec3 find_quarter(struct random *random)
{
    struct vec3 high, low;

    do
        high = random_point(random, 100.0);
    while (density_noise_octave(high) < 0.25);
    low = (struct vec3){floor(high.x), floor(high.y), floor(high.z)};
    for (int i = 0; i < 60; i++) {
        struct vec3 middle = vec3_scale(vec3_add(low, high), 0.5);

        if (density_noise_octave(middle) > 0.25) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return low;
}

static void bias_is_a_power_that_keeps_zero_and_one(void **state)
{
    struct density_noise_params params = ONE_OCTAVE;
    struct random random = {7};

    for (int i = 0; i < 500; i++) {
        struct vec3 point = random_point(&random, 100.0);
        double plain, bias = random_between(&random, -0.9, 0.9);

        params.bias = 0.0;
        plain = density_of(&params, point);
        params.bias = bias;
        assert_near(density_of(&params, point), pow(plain, (1.0 - bias) / (1.0 + bias)), 1e-12);
    }
    for (int i = 0; i < 20; i++) {
        params.bias = random_between(&random, -0.9, 0.9);
        params.octaves = 1;
        assert_true(density_of(&params, (struct vec3){i, -4.0, 5.0}) == 0.0);
        params.octaves = 4;
        params.lacunarity = 1.0;
        // 1e-12: the largest exponent is 19, which multiplies the roundings.
        assert_near(density_of(&params, find_quarter(&random)), 1.0, 1e-12);
    }
}

static void rotation_turns_the_point_about_the_center(void **state)
{
    struct density_noise_params turned = ONE_OCTAVE;
    struct random random = {8};

    turned.offset = (struct vec3){0.3, -0.7, 11.0};
    turned.center = (struct vec3){2.0, 5.0, -1.0};
    turned.frequency = 3.0;
    turned.mode = SCENE_NOISE_REMAP;
    for (int i = 0; i < 500; i++) {
        struct vec3 p = random_point(&random, 10.0), d = vec3_subtract(p, turned.center), q;
        double angle = random_between(&random, -7.0, 7.0), c = cos(angle), s = sin(angle);
        double wanted;

        turned.axis = (struct vec3){0.0, 0.25, 0.0};
        turned.angle_deg = angle * 180.0 / M_PI;
        q = vec3_add(vec3_scale((struct vec3){d.x * c + d.z * s, d.y, -d.x * s + d.z * c}, 3.0), turned.offset);
        wanted = 0.5 * (1.0 + density_noise_octave(q));
        assert_near(density_of(&turned, p), wanted, 1e-12);
        // A rotation by 120 degrees about the diagonal takes x to y, y to z, z to x.
        turned.axis = (struct vec3){1.0, 1.0, 1.0};
        turned.angle_deg = 120.0;
        q = vec3_add(vec3_scale((struct vec3){d.z, d.x, d.y}, 3.0), turned.offset);
        wanted = 0.5 * (1.0 + density_noise_octave(q));
        assert_near(density_of(&turned, p), wanted, 1e-12);
    }
}

static const enum scene_noise_mode MODES[] = {SCENE_NOISE_REMAP, SCENE_NOISE_CLIP, SCENE_NOISE_ABSOLUTE};

// In a ball, of several octaves, turned and with a bias.
static struct density bounded_noise(struct density_noise *noise, struct density_bounded *bounded,
                                    enum scene_noise_mode mode)
{
    struct density_noise_params params = ONE_OCTAVE;

    params.mode = mode;
    params.octaves = 4;
    params.frequency = 3.0;
    params.hurst = 0.6;
    params.bias = -0.2;
    params.angle_deg = 33.0;
    params.scale = 4.0;
    density_noise_init(noise, &params);
    *bounded = (struct density_bounded){density_noise_field(noise),
                                        {.kind = SCENE_BOUNDS_SPHERE, .radius = 1.0, .falloff = 0.3}};
    return density_bounded(bounded);
}

static void many_densities_have_the_bits_that_each_has_alone(void **state)
{
    enum { MOST = 40 };
    struct random random = {9};

    for (int i = 0; i < 3 * MOST; i++) {
        struct density_bounded bounded;
        struct density_noise noise;
        struct density density = bounded_noise(&noise, &bounded, MODES[i % 3]);
        double together[MOST], alone[MOST];
        struct vec3 positions[MOST];
        size_t count = 1 + (size_t)i / 3;

        for (size_t k = 0; k < count; k++) {
            positions[k] = random_point(&random, 0.8);
            alone[k] = density.at(density.field, positions[k]);
        }
        density_at_many(&density, count, positions, together);
        assert_memory_equal(together, alone, count * sizeof alone[0]);
        density_at_many(&bounded.inner, count, positions, together);
        for (size_t k = 0; k < count; k++)
            assert_true(together[k] == density_noise(&noise, positions[k]));
    }
}

// The part of the ray's column, by the midpoint rule, that lies in none of the spans.
static double missed_column(const struct density *density, const struct ray *ray, double far,
                            const struct span_list *spans)
{
    const int count = 20000;
    double missed = 0.0;
    size_t next = 0;

    for (int i = 0; i < count; i++) {
        double distance = (i + 0.5) * far / count;

        while (next < spans->count && spans->spans[next].end <= distance)
            next++;
        if (next < spans->count && spans->spans[next].begin <= distance) continue;
        missed += density->at(density->field, ray_at(ray, distance)) * far / count;
    }
    return missed;
}

static void rough_spans_miss_little_and_look_seldom(void **state)
{
    static const double TOLERANCES[] = {1e-2, 1e-3, 1e-4, 1e-5};
    struct random random = {10};
    struct density_bounded bounded;
    struct density_noise noise;
    struct density density = bounded_noise(&noise, &bounded, SCENE_NOISE_CLIP);
    size_t rough_count = 0, count = 0;

    for (int i = 0; i < 200; i++) {
        struct ray ray = {random_point(&random, 0.8), vec3_normalize(random_point(&random, 1.0))};
        double tolerance = TOLERANCES[i % 4];
        struct span_list spans = {0}, rough = {0};

        density.spans(density.field, &ray, 0.0, 3.0, &spans);
        density_rough_spans(&density, &ray, 0.0, 3.0, tolerance, &rough);
        assert_true(missed_column(&density, &ray, 3.0, &rough) <= tolerance);
        if (tolerance == 1e-2) rough_count += rough.count;
        if (tolerance == 1e-2) count += spans.count;
        span_list_finish(&spans);
        span_list_finish(&rough);
    }
    // Small bumps and gaps have no span of their own.
    assert_true(rough_count < count);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_has_the_published_value),
        cmocka_unit_test(noise_is_zero_at_every_lattice_point),
        cmocka_unit_test(slope_at_a_lattice_point_is_its_gradient),
        cmocka_unit_test(noise_repeats_after_256_cells_along_each_axis),
        cmocka_unit_test(slope_and_curvature_are_continuous_between_cells),
        cmocka_unit_test(noise_keeps_its_range_and_its_mean),
        cmocka_unit_test(octaves_add_by_lacunarity_and_h),
        cmocka_unit_test(bias_is_a_power_that_keeps_zero_and_one),
        cmocka_unit_test(rotation_turns_the_point_about_the_center),
        cmocka_unit_test(many_densities_have_the_bits_that_each_has_alone),
        cmocka_unit_test(rough_spans_miss_little_and_look_seldom),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
