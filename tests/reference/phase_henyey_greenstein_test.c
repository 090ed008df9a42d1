// SPDX-License-Identifier: Apache-2.0
#include "reference/phase_henyey_greenstein.h"

#include "reference/medium.h"
#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const double LOBES[] = {-0.999, -0.5, -0.2, 0.0, 0.3, 0.8, 0.99, 0.999};
enum { LOBE_COUNT = sizeof LOBES / sizeof LOBES[0] };

// Integrates cos^power p over the sphere. The substitution cos = sign(g) (1 - w^2) and w = v^3 resolves the peak of
// width 1 - |g|.
static double moment(double g, int power)
{
    const int count = 20000;
    double sign = g < 0.0 ? -1.0 : 1.0, limit = cbrt(sqrt(2.0)), sum = 0.0;

    for (int i = 0; i < count; i++) {
        double v = limit * (i + 0.5) / count;
        double w = v * v * v;
        double cos_theta = sign * (1.0 - w * w);

        sum += phase_henyey_greenstein(g, cos_theta) * pow(cos_theta, power) * 2.0 * w * 3.0 * v * v;
    }
    return 2.0 * M_PI * sum * limit / count;
}

static void scatters_all_light_somewhere(void **state)
{
    // 1e-6: the midpoint rule's error on 20000 cells at |g| = 0.999.
    for (int i = 0; i < LOBE_COUNT; i++)
        assert_near(moment(LOBES[i], 0), 1.0, 1e-6);
}

static void mean_cosine_is_g(void **state)
{
    for (int i = 0; i < LOBE_COUNT; i++)
        assert_near(moment(LOBES[i], 1), LOBES[i], 1e-6);
}

static void medium_without_lobes_scatters_evenly(void **state)
{
    struct medium medium = {.lobe_count = 0};

    assert_near(medium_phase(&medium, 0.7), 1.0 / (4.0 * M_PI), 1e-15);
    assert_near(medium_phase(&medium, -1.0), 1.0 / (4.0 * M_PI), 1e-15);
}

static void lobes_add_by_weight(void **state)
{
    struct medium medium = {.lobes = {{.g = 0.8, .weight = 0.25}, {.g = -0.2, .weight = 0.75}}, .lobe_count = 2};

    assert_near(medium_phase(&medium, 0.5),
                0.25 * phase_henyey_greenstein(0.8, 0.5) + 0.75 * phase_henyey_greenstein(-0.2, 0.5), 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scatters_all_light_somewhere),
        cmocka_unit_test(mean_cosine_is_g),
        cmocka_unit_test(medium_without_lobes_scatters_evenly),
        cmocka_unit_test(lobes_add_by_weight),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
