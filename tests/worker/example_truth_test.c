// The examples of fog and of a sunset at several moments against the converged integral, on both backends.
#include "core/job.h"
#include "tests/support/example_job.h"
#include "tests/support/true_light.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void assert_true_light(const char *name, double time, enum gl_backend backend, double tolerance)
{
    struct true_light light;
    struct job job;

    example_job_load(&job, name);
    example_job_shrink(&job, 24, 14, time);
    job.output.has_depth = job.output.has_transmittance = true;
    light = true_light_compare(&job, backend);
    assert_true(true_light_is_within(&light, tolerance));
    job_finish(&job);
}

// A ray crosses shadows of the balls, whose edges 32 points know to about a part in a thousand of the light.
static const double fog_tolerance = 1e-3;
// Places are known to a float's half metre 6360 km from the world's centre, ways to a few parts in ten thousand.
static const double sunset_tolerance = 1e-3;

static void fog_is_the_converged_light(void **state)
{
    assert_true_light("fog", 0, GL_BACKEND_OSMESA, fog_tolerance);
    assert_true_light("fog", 1.4, GL_BACKEND_OSMESA, fog_tolerance);
    // The light is behind a ball, whose shadow then fills the picture.
    assert_true_light("fog", 4.7, GL_BACKEND_OSMESA, 4e-3);
}

static void fog_is_the_converged_light_on_egl(void **state)
{
    assert_true_light("fog", 1.4, GL_BACKEND_EGL, fog_tolerance);
}

static void sunset_is_the_converged_light(void **state)
{
    assert_true_light("sunset", 0, GL_BACKEND_OSMESA, sunset_tolerance);
    assert_true_light("sunset", 5, GL_BACKEND_OSMESA, sunset_tolerance);
    assert_true_light("sunset", 9.9, GL_BACKEND_OSMESA, sunset_tolerance);
}

static void sunset_is_the_converged_light_on_egl(void **state)
{
    assert_true_light("sunset", 5, GL_BACKEND_EGL, sunset_tolerance);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fog_is_the_converged_light),
        cmocka_unit_test(fog_is_the_converged_light_on_egl),
        cmocka_unit_test(sunset_is_the_converged_light),
        cmocka_unit_test(sunset_is_the_converged_light_on_egl),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
