// SPDX-License-Identifier: Apache-2.0
#include "core/scene/timeline.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

// Values of order 1 after a few roundings.
static const double ROUNDING = 1e-14;

static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance)) fail_msg("expected %.17g, got %.17g", expected, value);
}

static void assert_value(const struct timeline *timeline, double time, double x, double y, double z)
{
    double value[3];

    timeline_evaluate(timeline, time, value);
    assert_near(value[0], x, ROUNDING);
    assert_near(value[1], y, ROUNDING);
    assert_near(value[2], z, ROUNDING);
}

static double number_at(const struct timeline *timeline, double time)
{
    double value[3] = {0.0, 77.0, 77.0};

    timeline_evaluate(timeline, time, value);
    assert_true(value[1] == 77.0 && value[2] == 77.0);
    return value[0];
}

static void zero_value_is_the_constant_0(void **state)
{
    struct timeline timeline = {.component_count = 1};

    assert_true(number_at(&timeline, 3.0) == 0.0);
    assert_true(timeline_is_constant(&timeline));
    timeline_finish(&timeline);
}

static void linear_starts_at_time_0(void **state)
{
    struct timeline timeline = {
        .kind = TIMELINE_LINEAR, .component_count = 3, .linear = {.start = {1, 2, 3}, .rate = {-0.5, 0, 2}}};

    assert_value(&timeline, 0.0, 1.0, 2.0, 3.0);
    assert_value(&timeline, 4.0, -1.0, 2.0, 11.0);
    assert_false(timeline_is_constant(&timeline));
}

static void lissajous_follows_its_formula(void **state)
{
    struct timeline timeline = {.kind = TIMELINE_LISSAJOUS,
                                .component_count = 3,
                                .lissajous = {.center = {1, 2, 3},
                                              .amplitude = {1.5, 1.2, 1.1},
                                              .frequency_rad = {3.1, 2.2, 4.3},
                                              .phase_rad = {0.2, 0.0, -0.4},
                                              .speed = 0.2}};

    for (double t = -3.0; t < 10.0; t += 0.7)
        assert_value(&timeline, t, 1.0 + 1.5 * sin(0.62 * t + 0.2), 2.0 + 1.2 * sin(0.44 * t),
                     3.0 + 1.1 * sin(0.86 * t - 0.4));
}

static struct timeline_key three_keys[] = {{1.0, {10.0}}, {2.0, {20.0}}, {4.0, {0.0}}};

static struct timeline timeline_through_keys(enum timeline_interpolation interpolation)
{
    return (struct timeline){.kind = TIMELINE_KEYS, .component_count = 1, .keys = {three_keys, 3, interpolation}};
}

static void keys_hold_before_the_first_and_after_the_last(void **state)
{
    for (int i = TIMELINE_INTERPOLATE_LINEAR; i <= TIMELINE_INTERPOLATE_HOLD; i++) {
        struct timeline timeline = timeline_through_keys((enum timeline_interpolation)i);

        assert_true(number_at(&timeline, -1e9) == 10.0);
        assert_true(number_at(&timeline, 1.0) == 10.0);
        assert_true(number_at(&timeline, 2.0) == 20.0);
        assert_true(number_at(&timeline, 4.0) == 0.0);
        assert_true(number_at(&timeline, 1e9) == 0.0);
    }
}

static void linear_keys_join_by_straight_lines(void **state)
{
    struct timeline timeline = timeline_through_keys(TIMELINE_INTERPOLATE_LINEAR);

    assert_near(number_at(&timeline, 1.25), 12.5, ROUNDING);
    assert_near(number_at(&timeline, 3.5), 5.0, ROUNDING);
}

// A value may equal the end of its range.
static void between_keys_no_value_is_beyond_them(void **state)
{
    static const double values[] = {0.1, 10, 0.99999, -0.99999, 1e9};

    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
        for (int frame = 0; frame < 2400; frame++) {
            struct timeline_key keys[] = {{0, {values[i]}}, {100, {values[i]}}, {101, {0}}};
            struct timeline timeline = {
                .kind = TIMELINE_KEYS,
                .component_count = 1,
                .keys = {keys, 3, frame % 2 ? TIMELINE_INTERPOLATE_LINEAR : TIMELINE_INTERPOLATE_SMOOTH}};

            assert_true(number_at(&timeline, frame / 24.0) == values[i]);
        }
}

static void smooth_keys_join_by_smoothstep(void **state)
{
    struct timeline timeline = timeline_through_keys(TIMELINE_INTERPOLATE_SMOOTH);

    for (double share = 0.0; share < 1.0; share += 0.125) {
        double smoothstep = 3.0 * share * share - 2.0 * share * share * share;

        assert_near(number_at(&timeline, 1.0 + share), 10.0 + 10.0 * smoothstep, ROUNDING);
        assert_near(number_at(&timeline, 2.0 + 2.0 * share), 20.0 - 20.0 * smoothstep, ROUNDING);
    }
}

static void held_keys_jump(void **state)
{
    struct timeline timeline = timeline_through_keys(TIMELINE_INTERPOLATE_HOLD);

    assert_true(number_at(&timeline, nextafter(2.0, 0.0)) == 10.0);
    assert_true(number_at(&timeline, nextafter(4.0, 0.0)) == 20.0);
}

static void each_of_many_keys_is_found(void **state)
{
    static struct timeline_key keys[1000];
    struct timeline timeline = {.kind = TIMELINE_KEYS, .component_count = 1, .keys = {keys, 1000, 0}};

    for (int i = 0; i < 1000; i++)
        keys[i] = (struct timeline_key){.time = i * i, .value = {i}};
    for (int i = 0; i < 1000; i++)
        assert_true(number_at(&timeline, i * i) == i);
}

static struct timeline orbit_about(double x, double y, double z)
{
    return (struct timeline){.kind = TIMELINE_ORBIT,
                             .component_count = 3,
                             .orbit = {.axis = {x, y, z}, .center = {1, 2, 3}, .radius = 2.0, .period = 8.0}};
}

static void orbit_about_y_starts_at_x_and_goes_to_minus_z(void **state)
{
    struct timeline timeline = orbit_about(0.0, 5.0, 0.0);

    timeline.orbit.height = 0.5;
    assert_value(&timeline, 0.0, 3.0, 2.5, 3.0);
    assert_value(&timeline, 1.0, 1.0 + sqrt(2.0), 2.5, 3.0 - sqrt(2.0));
    assert_value(&timeline, 2.0, 1.0, 2.5, 1.0);
    assert_value(&timeline, 6.0, 1.0, 2.5, 5.0);
    assert_value(&timeline, 8.0, 3.0, 2.5, 3.0);
}

static void orbit_about_z_goes_from_x_to_y(void **state)
{
    struct timeline timeline = orbit_about(0.0, 0.0, 0.1);

    assert_value(&timeline, 0.0, 3.0, 2.0, 3.0);
    assert_value(&timeline, 2.0, 1.0, 4.0, 3.0);
    timeline.orbit.phase_rad = M_PI / 2.0;
    assert_value(&timeline, 0.0, 1.0, 4.0, 3.0);
    timeline.orbit.period = -8.0;
    assert_value(&timeline, 2.0, 3.0, 2.0, 3.0);
}

static void orbit_about_x_starts_at_y(void **state)
{
    struct timeline timeline = orbit_about(-3.0, 0.0, 0.0);

    assert_value(&timeline, 0.0, 1.0, 4.0, 3.0);
    assert_value(&timeline, 2.0, 1.0, 2.0, 1.0);
}

static void orbit_is_counter_clockwise_seen_from_the_tip_of_any_axis(void **state)
{
    static const double axes[][3] = {{1, 1, 1}, {-2, 0.3, 5}, {0.99, 0.1, 0}, {1, 0, 0.01}, {0, -1, 0}, {-4, 0, 1}};

    for (size_t i = 0; i < sizeof axes / sizeof axes[0]; i++) {
        const double *a = axes[i];
        struct timeline timeline = orbit_about(a[0], a[1], a[2]);
        double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
        double p[3], q[3], along_p, turn;

        timeline_evaluate(&timeline, 1.7, p);
        timeline_evaluate(&timeline, 1.7 + 2.0, q);
        for (int k = 0; k < 3; k++) {
            p[k] -= timeline.orbit.center[k];
            q[k] -= timeline.orbit.center[k];
        }
        along_p = p[0] * a[0] + p[1] * a[1] + p[2] * a[2];
        turn = a[0] * (p[1] * q[2] - p[2] * q[1]) + a[1] * (p[2] * q[0] - p[0] * q[2]) +
               a[2] * (p[0] * q[1] - p[1] * q[0]);
        assert_near(along_p, 0.0, 1e-13); // a dozen roundings of numbers up to 10
        assert_near(turn, 4.0 * length, 1e-13);
    }
}

static void constancy_is_about_the_value_not_the_kind(void **state)
{
    struct timeline_key same[] = {{0.0, {1, 2, 3}}, {5.0, {1, 2, 3}}};
    struct timeline linear = {.kind = TIMELINE_LINEAR, .component_count = 1, .linear = {.start = {2}}};
    struct timeline keys = {.kind = TIMELINE_KEYS, .component_count = 3, .keys = {same, 2, 0}};
    struct timeline lissajous = {.kind = TIMELINE_LISSAJOUS,
                                 .component_count = 3,
                                 .lissajous = {.amplitude = {0, 0, 1}, .frequency_rad = {1, 1, 1}}};
    struct timeline orbit = orbit_about(0.0, 1.0, 0.0);

    assert_true(timeline_is_constant(&linear));
    assert_true(timeline_is_constant(&keys));
    assert_true(timeline_is_constant(&lissajous));
    assert_false(timeline_is_constant(&orbit));
    lissajous.lissajous.speed = 1.0;
    assert_false(timeline_is_constant(&lissajous));
    same[1].value[2] = 4.0;
    assert_false(timeline_is_constant(&keys));
    orbit.orbit.radius = 0.0;
    assert_true(timeline_is_constant(&orbit));
}

static void bounds_hold_every_value_and_are_reached(void **state)
{
    struct timeline timelines[] = {
        orbit_about(1.0, 2.0, -0.5),
        {.kind = TIMELINE_LISSAJOUS,
         .component_count = 3,
         .lissajous = {.center = {1, 2, 3}, .amplitude = {-1.5, 1.2, 0}, .frequency_rad = {3, 2, 4}, .speed = 1}},
        {.kind = TIMELINE_LINEAR, .component_count = 3, .linear = {.start = {1, 2, 3}, .rate = {-1, 0, 2}}},
        {.kind = TIMELINE_KEYS, .component_count = 1, .keys = {three_keys, 3, TIMELINE_INTERPOLATE_SMOOTH}},
    };
    struct timeline_span span = {-1.0, 20.0};

    for (size_t i = 0; i < sizeof timelines / sizeof timelines[0]; i++) {
        double min[3], max[3], value[3], low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};

        timeline_find_bounds(&timelines[i], span, min, max);
        for (int step = 0; step <= 21000; step++) {
            timeline_evaluate(&timelines[i], -1.0 + step * 1e-3, value);
            for (int k = 0; k < timelines[i].component_count; k++) {
                low[k] = fmin(low[k], value[k]);
                high[k] = fmax(high[k], value[k]);
            }
        }
        for (int k = 0; k < timelines[i].component_count; k++) {
            assert_true(low[k] >= min[k] - ROUNDING && high[k] <= max[k] + ROUNDING);
            assert_near(low[k], min[k], 1e-5); // an extreme is missed by at most half a sampling step
            assert_near(high[k], max[k], 1e-5);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(zero_value_is_the_constant_0),
        cmocka_unit_test(linear_starts_at_time_0),
        cmocka_unit_test(lissajous_follows_its_formula),
        cmocka_unit_test(keys_hold_before_the_first_and_after_the_last),
        cmocka_unit_test(linear_keys_join_by_straight_lines),
        cmocka_unit_test(smooth_keys_join_by_smoothstep),
        cmocka_unit_test(held_keys_jump),
        cmocka_unit_test(between_keys_no_value_is_beyond_them),
        cmocka_unit_test(each_of_many_keys_is_found),
        cmocka_unit_test(orbit_about_y_starts_at_x_and_goes_to_minus_z),
        cmocka_unit_test(orbit_about_z_goes_from_x_to_y),
        cmocka_unit_test(orbit_about_x_starts_at_y),
        cmocka_unit_test(orbit_is_counter_clockwise_seen_from_the_tip_of_any_axis),
        cmocka_unit_test(constancy_is_about_the_value_not_the_kind),
        cmocka_unit_test(bounds_hold_every_value_and_are_reached),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
