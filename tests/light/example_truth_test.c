// Example jobs (fog, a sunset, objects) at several moments against the converged integral, on both backends.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "tests/support/example_job.h"
#include "tests/support/true_light.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// Takes one sample a pixel and makes surfaces smooth: no random number is left, and each pixel has one true value.
static void look_through_centres(struct job *job)
{
    job->quality.samples = 1;
    for (size_t i = 0; i < job->scene.object_count; i++) {
        struct timeline *roughness = &job->scene.objects[i].material.roughness;

        timeline_finish(roughness);
        *roughness = (struct timeline){.component_count = 1};
    }
}

// The reference is slow on marched media: their pictures are smaller.
static bool is_marched(const struct job *job)
{
    return job->quality.method != JOB_METHOD_EQUIANGULAR;
}

static void assert_true_light(const char *name, double time, enum gl_backend backend, double tolerance)
{
    struct true_light light;
    struct job job;

    example_job_load(&job, name);
    example_job_shrink(&job, is_marched(&job) ? 16 : 24, is_marched(&job) ? 9 : 14, time);
    look_through_centres(&job);
    job.output.has_depth = job.output.has_transmittance = true;
    light = true_light_compare(&job, backend);
    assert_true(true_light_is_within(&light, tolerance));
    job_finish(&job);
}

// Rays cross shadows of the balls. The job's 32 points resolve the edges of shadows to about 1e-3 of the light.
static const double fog_tolerance = 1e-3;
// Positions 6360 km from the world's centre are rounded to half a metre in floats. Lengths of paths change by
// a few parts in ten thousand.
static const double sunset_tolerance = 1e-3;

// Nothing is marched. Reflections in the ball amplify roundings of floats.
static const double surface_tolerance = 1e-4;
// Jitter makes noise of the error of steps. The job's four samples have half of this.
static const double translucent_tolerance = 2e-2;
// The error of the steps through smoke, mostly of those of shadow rays.
static const double globe_tolerance = 1e-2;

static void fog_is_the_converged_light(void **state)
{
    assert_true_light("fog", 0, GL_BACKEND_SOFTWARE, fog_tolerance);
    assert_true_light("fog", 1.4, GL_BACKEND_SOFTWARE, fog_tolerance);
    // The light is behind a ball, whose shadow then fills the picture.
    assert_true_light("fog", 4.7, GL_BACKEND_SOFTWARE, 4e-3);
}

static void fog_is_the_converged_light_on_egl(void **state)
{
    assert_true_light("fog", 1.4, GL_BACKEND_EGL, fog_tolerance);
}

static void sunset_is_the_converged_light(void **state)
{
    assert_true_light("sunset", 0, GL_BACKEND_SOFTWARE, sunset_tolerance);
    assert_true_light("sunset", 5, GL_BACKEND_SOFTWARE, sunset_tolerance);
    assert_true_light("sunset", 9.9, GL_BACKEND_SOFTWARE, sunset_tolerance);
}

static void sunset_is_the_converged_light_on_egl(void **state)
{
    assert_true_light("sunset", 5, GL_BACKEND_EGL, sunset_tolerance);
}

static void glass_is_the_converged_light(void **state)
{
    assert_true_light("glass", 0, GL_BACKEND_SOFTWARE, surface_tolerance);
    assert_true_light("glass", 6, GL_BACKEND_SOFTWARE, surface_tolerance);
}

static void glass_is_the_converged_light_on_egl(void **state)
{
    assert_true_light("glass", 2, GL_BACKEND_EGL, surface_tolerance);
}

static void opaque_is_the_converged_light(void **state)
{
    assert_true_light("opaque", 0, GL_BACKEND_SOFTWARE, surface_tolerance);
    assert_true_light("opaque", 8, GL_BACKEND_SOFTWARE, surface_tolerance);
}

static void mirror_is_the_converged_light(void **state)
{
    assert_true_light("mirror", 0, GL_BACKEND_SOFTWARE, surface_tolerance);
    assert_true_light("mirror", 4, GL_BACKEND_SOFTWARE, surface_tolerance);
}

static void translucent_is_the_converged_light(void **state)
{
    assert_true_light("translucent", 0.5, GL_BACKEND_SOFTWARE, translucent_tolerance);
    assert_true_light("translucent", 6, GL_BACKEND_SOFTWARE, translucent_tolerance);
}

static void globe_is_the_converged_light(void **state)
{
    assert_true_light("globe", 6, GL_BACKEND_SOFTWARE, globe_tolerance);
}

static void globe_is_the_converged_light_on_egl(void **state)
{
    assert_true_light("globe", 3.3, GL_BACKEND_EGL, globe_tolerance);
}

// One argument: the tests to run, by a pattern.
int main(int argc, char *argv[])
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fog_is_the_converged_light),          cmocka_unit_test(fog_is_the_converged_light_on_egl),
        cmocka_unit_test(sunset_is_the_converged_light),       cmocka_unit_test(sunset_is_the_converged_light_on_egl),
        cmocka_unit_test(glass_is_the_converged_light),        cmocka_unit_test(glass_is_the_converged_light_on_egl),
        cmocka_unit_test(opaque_is_the_converged_light),       cmocka_unit_test(mirror_is_the_converged_light),
        cmocka_unit_test(translucent_is_the_converged_light),  cmocka_unit_test(globe_is_the_converged_light),
        cmocka_unit_test(globe_is_the_converged_light_on_egl),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
