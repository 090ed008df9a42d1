// What each method promises, measured where methods fail.
// SPDX-License-Identifier: Apache-2.0
// "print points" prints every point of every sweep, "print map" docs/stability.md's table, "print svg" its picture.
// Else: a pattern of the tests to run, and the slug of the one sweep to be looked at.
#include "core/base/error.h"
#include "tests/support/keep_libraries.h"
#include "tests/support/stability.h"
#include "tests/support/stability_map.h"
#include "worker/gl/gl_context.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static struct gl_context *context;

// The promise for values from `low` to `high`: no error exceeds `error`, and no more light is gained than the share
// `gain` of all.
struct promise {
    const char *slug, *method;
    double low, high, error, gain;
};

static const struct promise promises[] = {
    // Segments are integrated exactly, whatever their depth; plain sums are not.
    {"furnace", "midpoint", 1e-3, 1000, 1e-5, 1e-6},
    {"furnace", "jittered", 1e-3, 1000, 1e-5, 1e-6},
    {"furnace", "adaptive", 1e-3, 1000, 1e-5, 1e-6},
    {"furnace", "gauss", 1e-3, 1000, 1e-5, 1e-6},
    {"furnace", "equiangular", 1e-3, 1000, 1e-5, 1e-6},
    {"furnace", "cached", 1e-3, 1000, 1e-5, 1e-6},
    {"furnace", "tracking", 1e-3, 1000, 2e-5, 1e-5},
    {"depth", "cached", 1e-6, 10, 1e-2, 5e-3},
    {"forward", "cached", -0.999, 0.999, 3e-3, 3e-3},
    {"backward", "cached", -0.999, 0.999, 3e-3, 3e-3},
    {"camera", "cached", 0, 1, 2e-3, 1e-3},
    {"far", "cached", 1, 1e6, 2e-3, 2e-3},
    {"shell", "cached", 10, 10, 1e-2, 1e-3},
    {"origin", "cached", 0, 1e8, 2e-3, 1e-3},
    {"bright", "cached", 1, 1e12, 2e-3, 2e-3},
    {"furnace", "riemann", 1e-3, 1e-2, 2e-3, 2e-3},
    {"depth", "midpoint", 1e-6, 10, 3e-3, 3e-3},
    {"depth", "midpoint", 100, 100, 2e-2, 0.1},
    {"depth", "jittered", 1e-6, 10, 5e-2, 5e-3},
    {"depth", "adaptive", 1e-6, 10, 3e-3, 3e-3},
    {"depth", "adaptive", 100, 1e4, 3e-2, 3e-2},
    {"depth", "gauss", 1e-6, 100, 1e-4, 1e-4},
    {"depth", "equiangular", 1e-6, 1e4, 1e-2, 1e-3},
    {"forward", "midpoint", -0.999, 0.999, 1e-3, 1e-3},
    {"forward", "jittered", -0.999, 0.999, 3e-2, 5e-3},
    {"forward", "adaptive", -0.999, 0.999, 1e-3, 1e-3},
    {"forward", "gauss", -0.999, 0.999, 1e-4, 1e-4},
    {"forward", "equiangular", -0.999, 0.999, 1e-3, 1e-3},
    {"backward", "midpoint", -0.999, 0.999, 1e-3, 1e-3},
    {"backward", "jittered", -0.999, 0.999, 5e-2, 1e-2},
    {"backward", "adaptive", -0.999, 0.999, 1e-3, 1e-3},
    {"backward", "gauss", -0.999, 0.999, 1e-4, 1e-4},
    {"backward", "equiangular", -0.999, 0.999, 1e-3, 1e-3},
    {"inside", "midpoint", 1e-6, 0.3, 5e-3, 3e-3},
    {"inside", "adaptive", 1e-6, 0.3, 5e-3, 3e-3},
    {"inside", "cached", 1e-6, 0.3, 5e-3, 3e-3},
    {"inside", "gauss", 1e-6, 0.3, 1e-3, 1e-3},
    {"inside", "jittered", 1e-6, 0.3, 4e-2, 1e-2},
    {"inside", "equiangular", 1e-6, 0.3, 2e-3, 2e-3},
    {"camera", "midpoint", 0, 1, 1e-3, 1e-3},
    {"camera", "adaptive", 0, 1, 1e-3, 1e-3},
    {"camera", "gauss", 0, 1, 1e-4, 1e-4},
    {"camera", "equiangular", 0, 1, 1e-4, 1e-4},
    {"far", "midpoint", 1, 1e6, 1e-3, 1e-3},
    {"far", "jittered", 1, 1e6, 3e-2, 5e-3},
    {"far", "adaptive", 1, 1e6, 1e-3, 1e-3},
    {"far", "gauss", 1, 1e6, 1e-4, 1e-4},
    {"far", "equiangular", 1, 1e6, 1e-3, 1e-3},
    {"far", "riemann", 1, 1, 2e-2, 1e-2},
    {"shell", "midpoint", 10, 10, 1e-2, 1e-3},
    {"shell", "adaptive", 1e-3, 10, 2e-2, 2e-2},
    {"shell", "gauss", 0.1, 10, 2e-3, 2e-3},
    {"shell", "equiangular", 1e-3, 10, 2e-2, 2e-3},
    {"origin", "midpoint", 0, 1e8, 1e-3, 1e-3},
    {"origin", "adaptive", 0, 1e8, 1e-3, 1e-3},
    {"origin", "jittered", 0, 1e8, 3e-2, 5e-3},
    {"origin", "gauss", 0, 1e8, 1e-4, 1e-4},
    {"origin", "equiangular", 0, 1e8, 1e-3, 1e-3},
    {"bright", "midpoint", 1, 1e12, 1e-3, 1e-3},
    {"bright", "adaptive", 1, 1e12, 1e-3, 1e-3},
    {"bright", "gauss", 1, 1e12, 1e-4, 1e-4},
    {"bright", "equiangular", 1, 1e12, 1e-3, 1e-3},
    {"side", "midpoint", 1, 64, 1e-3, 1e-3},
    {"side", "jittered", 1, 64, 2e-2, 5e-3},
    {"side", "adaptive", 1, 64, 1e-3, 1e-3},
    {"side", "gauss", 1, 64, 2e-4, 2e-4},
    {"side", "cached", 1, 64, 1e-3, 1e-3},
    {"aspect", "midpoint", 0.1, 100, 1e-3, 1e-3},
    {"aspect", "jittered", 0.1, 100, 2e-2, 5e-3},
    {"aspect", "adaptive", 0.1, 100, 1e-3, 1e-3},
    {"aspect", "gauss", 0.1, 100, 2e-4, 2e-4},
    {"aspect", "cached", 0.1, 100, 1e-3, 1e-3},
    {"transfer", "midpoint", 0.3, 0.3, 1e-2, 1e-2},
    {"transfer", "adaptive", 0.1, 0.3, 2e-2, 1e-2},
    {"transfer", "gauss", 0.1, 0.3, 1e-2, 1e-2},
    {"transfer", "preintegrated", 1e-3, 0.3, 1.5e-2, 1e-2},
    {"lipschitz", "midpoint", 1, 1, 1e-2, 1e-2},
    {"lipschitz", "adaptive", 1, 1, 1e-2, 1e-2},
    {"lipschitz", "gauss", 1, 1, 1e-3, 1e-3},
    {"lipschitz", "cached", 1, 1, 1e-2, 1e-2},
    {"flicker", "midpoint", 0, 0.1, 1e-4, 1e-3},
    {"flicker", "jittered", 0, 0.1, 4e-2, 1e-2},
    {"flicker", "adaptive", 0, 0.1, 1e-4, 1e-3},
    {"flicker", "gauss", 0, 0.1, 1e-5, 1e-4},
    {"flicker", "equiangular", 0, 0.1, 1e-4, 1e-3},
    {"flicker", "cached", 0, 0.1, 5e-4, 1e-3},
    // What is as long or as wide as the lattice's steps; what is smaller may be missed.
    {"filament", "pixels 16", 1, 16, 1e-3, 1e-4},
    {"filament", "pixels 4", 1, 16, 1e-3, 1e-4},
    {"speck", "pixels 16", 1, 16, 1e-4, 1e-4},
    {"speck", "pixels 4", 1, 16, 1e-4, 1e-4},
    {"glint", "pixels 16", 16, 16, 1e-5, 1e-5},
    {"glint", "pixels 4", 4, 16, 1e-5, 1e-5},
    {"checker", "pixels 16", 32, 64, 1e-5, 1e-5},
    {"checker", "pixels 4", 8, 64, 1e-5, 1e-5},
    {"blink", "pixels 16", 0, 0.1, 5e-4, 1e-4},
    {"blink", "pixels 4", 0, 0.1, 5e-4, 1e-4},
    {"pan", "pixels 16", 0, 10, 1e-3, 1e-4},
    {"pan", "pixels 4", 0, 10, 1e-3, 1e-4},
};

static bool check(const struct promise *promise, double value, const struct stability_point *point)
{
    bool is_kept =
        !point->is_refused && point->is_finite && point->error <= promise->error && point->gain <= promise->gain;

    if (!is_kept)
        printf("%s, %s at %g: %s, error %.2e, of %.1e, gain %+.2e of %.1e\n", promise->slug, promise->method, value,
               point->is_refused  ? point->reason
               : point->is_finite ? "finite"
                                  : "not finite",
               point->error, promise->error, point->gain, promise->gain);
    return is_kept;
}

static const char *only; // the slug of the one sweep to be looked at; NULL: all

static bool is_left_out(const struct stability_sweep *sweep)
{
    return only && strcmp(sweep->slug, only) != 0;
}

// No method turns a scene into NaN or infinity, nor light into negative light, whatever the value of a sweep.
static int check_sweep(const struct stability_sweep *all, const struct stability_method *method, size_t *checks)
{
    const struct stability_sweep quick = stability_quick(all), *sweep = &quick;
    struct stability_point points[STABILITY_POINT_LIMIT];
    int broken = 0;

    if (is_left_out(sweep) || !stability_concerns(sweep, method) || method->tolerance > 0) return 0;
    if (!stability_measure(context, sweep, method, points)) return 1;
    for (size_t i = 0; i < sweep->count; i++) {
        if (!points[i].is_refused && (!points[i].is_finite || points[i].gain < -1.0001)) {
            printf("%s, %s at %g: not finite\n", sweep->slug, method->name, sweep->values[i]);
            broken++;
        }
        for (size_t k = 0; k < sizeof promises / sizeof *promises; k++) {
            const struct promise *promise = &promises[k];

            if (strcmp(promise->slug, sweep->slug) != 0 || strcmp(promise->method, method->name) != 0) continue;
            if (sweep->values[i] < promise->low || sweep->values[i] > promise->high) continue;
            broken += !check(promise, sweep->values[i], &points[i]);
            ++*checks;
        }
    }
    return broken;
}

static void methods_keep_their_promises(void **state)
{
    size_t checks = 0;
    int broken = 0;

    (void)state;
    for (size_t i = 0; i < stability_sweep_count; i++)
        for (size_t k = 0; k < stability_method_count; k++)
            broken += check_sweep(&stability_sweeps[i], &stability_methods[k], &checks);
    print_message("%zu promises looked at\n", checks);
    assert_int_equal(broken, 0);
    assert_true(only || checks > 250);
}

// Sweeps whose error no plan can bring below the tolerance, which is known.
static bool may_refuse(const struct stability_sweep *sweep, double value)
{
    return strcmp(sweep->slug, "lipschitz") == 0 && value > 1;
}

static int check_planned(const struct stability_sweep *sweep, const struct stability_method *method, int *refused)
{
    struct stability_point point;

    if (!stability_measure(context, sweep, method, &point)) return 1;
    *refused += point.is_refused;
    printf("%s, %s at %g: %s, error %.2e\n", sweep->slug, method->name, sweep->values[0],
           point.is_refused ? point.reason : "kept", point.error);
    if (point.is_refused) return !may_refuse(sweep, sweep->values[0]) || !strstr(point.reason, "quality.tolerance");
    // The change between two frames has the errors of both.
    return !point.is_finite || point.error > (sweep->is_change ? 2 : 1) * method->tolerance;
}

// The last value of each row is tested, where it is worst; "print" covers the rest.
static void auto_keeps_its_tolerance_or_says_why(void **state)
{
    int broken = 0, refused = 0;

    (void)state;
    for (size_t i = 0; i < stability_sweep_count; i++)
        for (size_t k = 0; k < stability_method_count; k++) {
            struct stability_sweep last = stability_quick(&stability_sweeps[i]);

            if (is_left_out(&last) || !(stability_methods[k].tolerance > 0)) continue;
            last.values[0] = last.values[last.count - 1];
            last.count = 1;
            broken += check_planned(&last, &stability_methods[k], &refused);
        }
    assert_int_equal(broken, 0);
    // A promise that cannot be kept is refused.
    assert_int_equal(refused, !only || strcmp(only, "lipschitz") == 0);
}

// A value that the picture's numbers cannot hold is reported, not written.
static void half_overflow_is_reported(void **state)
{
    const struct stability_sweep *bright = stability_sweeps;
    struct stability_point points[STABILITY_POINT_LIMIT];

    (void)state;
    while (strcmp(bright->slug, "bright") != 0)
        bright++;
    assert_true(stability_measure(context, bright, &stability_methods[1], points));
    assert_true(points[0].fits_half);
    assert_false(points[bright->count - 1].fits_half);
    assert_true(points[bright->count - 1].is_finite);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(methods_keep_their_promises),
        cmocka_unit_test(auto_keeps_its_tolerance_or_says_why),
        cmocka_unit_test(half_overflow_is_reported),
    };
    struct error error = {{0}};
    int status;

    context = gl_context_create(GL_BACKEND_SOFTWARE, NULL, &error);
    keep_libraries();
    if (!context) {
        printf("%s\n", error.message);
        return 1;
    }
    if (argc > 2 && strcmp(argv[1], "print") == 0) {
        status = !stability_map_print(context, argv[2], argc > 3 ? argv[3] : NULL);
    } else {
        if (argc > 1) cmocka_set_test_filter(argv[1]);
        if (argc > 2) only = argv[2];
        status = cmocka_run_group_tests(tests, NULL, NULL);
    }
    gl_context_destroy(context);
    return status;
}
