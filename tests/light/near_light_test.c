// Point lights inside marched media: rays that pass a light closer than a step, against the converged integral.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "tests/support/ball_job.h"
#include "tests/support/true_light.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

// The ball's density falls off outwards, so that it is marched. A lamp is inside.
static struct true_light compare(const char *lamp, const char *quality)
{
    struct true_light light;
    struct job job;
    char rest[512];

    snprintf(rest, sizeof rest,
             "\"lights\": [{\"kind\": \"point\", \"intensity\": 3, \"position\": [%s]}],"
             "\"quality\": {%s}",
             lamp, quality);
    ball_job_parse(&job, "\"sigma_s\": 1, \"sigma_a\": 0.2, \"phase\": [{\"g\": 0.5}]", rest);
    job.scene.media[0].density.bounds.falloff = (struct timeline){.component_count = 1, .value = {0.3}};
    job.width_px = 9;
    job.height_px = 7;
    light = true_light_compare(&job, GL_BACKEND_SOFTWARE);
    job_finish(&job);
    return light;
}

// The middle pixel's ray passes a lamp at a twentieth and at a 200th of a step. Equal steps have an error of half of
// the light and more.
static void a_ray_that_passes_a_lamp_shows_its_light(void **state)
{
    static const char *const lamps[] = {"0.005, 0.001, 0.013", "0.0005, 0, 0.013"};
    static const struct {
        const char *quality;
        double error;
    } methods[] = {
        {"\"method\": \"cached\", \"step\": 0.1, \"light_grid\": 96", 1.3e-3},
        {"\"method\": \"gauss\", \"step\": 0.1, \"light_step\": 0.1, \"order\": 3", 1e-4},
        // The error of one sample is noise that comes from elsewhere.
        {"\"method\": \"jittered\", \"step\": 0.1, \"light_step\": 0.1", 3e-3},
    };

    (void)state;
    for (size_t i = 0; i < 2; i++)
        for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
            struct true_light light = compare(lamps[i], methods[k].quality);

            assert_true(light.radiance.relative_rmse < methods[k].error);
        }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_ray_that_passes_a_lamp_shows_its_light),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // name pattern
    return cmocka_run_group_tests(tests, NULL, NULL);
}
