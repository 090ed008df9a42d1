// The scene of jobs/noise.json is the one in its name: the test computes its density again, from frame numbers.
// SPDX-License-Identifier: Apache-2.0
#include "core/job/job.h"
#include "reference/still.h"
#include "tests/support/assert_near.h"
#include "tests/support/example_job.h"
#include "tests/support/random.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// The density is a ball of radius 1 whose outer fifth fades out, of five clipped octaves that rotate once in 120
// frames.
static double density_of_frame(int frame, struct vec3 p)
{
    double theta = (frame - 1) / 120.0 * 2.0 * M_PI;
    struct vec3 turned = {cos(theta) * p.x + sin(theta) * p.z, p.y, -sin(theta) * p.x + cos(theta) * p.z};
    struct vec3 q = vec3_add(vec3_scale(turned, 1.1), (struct vec3){3.7, 1.2, 8.4});
    double outwards = fmin(fmax((vec3_length(p) - 0.8) / 0.2, 0.0), 1.0);
    double falloff = outwards * outwards * (3.0 - 2.0 * outwards);
    double sum = 0.0;

    for (int i = 0; i < 5; i++) {
        sum += density_noise_octave(q) * pow(2.0, -0.4 * i);
        q = vec3_scale(q, 2.0);
    }
    return fmax(sum, 0.0) * (1.0 - falloff);
}

static void density_is_the_documents_in_every_frame(void **state)
{
    static const int FRAMES[] = {1, 16, 31, 76, 120};
    struct random random = {31};
    int positive = 0;
    struct job job;

    example_job_load(&job, "noise");
    assert_int_equal(frame_range_count(&job.frames), 120);
    assert_int_equal(frame_range_at(&job.frames, 0), 1);
    for (size_t i = 0; i < sizeof FRAMES / sizeof *FRAMES; i++) {
        struct still still;

        still_init(&still, &job, job_frame_time(&job, FRAMES[i]));
        assert_int_equal(still.medium_count, 1);
        for (int k = 0; k < 400; k++) {
            double x = random_between(&random, -1.1, 1.1), y = random_between(&random, -1.1, 1.1);
            struct vec3 p = {x, y, random_between(&random, -1.1, 1.1)};
            double wanted = density_of_frame(FRAMES[i], p);

            // 1e-12: roundings of the angle, times slopes that reach 40 in the finest octave.
            assert_near(still.media[0].density.at(still.media[0].density.field, p), wanted, 1e-12);
            positive += wanted > 0.0;
        }
    }
    assert_true(positive > 300);
    job_finish(&job);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(density_is_the_documents_in_every_frame),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
