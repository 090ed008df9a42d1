// SPDX-License-Identifier: Apache-2.0
#include "reference/phase_rayleigh.h"

#include "reference/medium.h"
#include "reference/phase_henyey_greenstein.h"
#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void scatters_all_light_somewhere(void **state)
{
    const int count = 20000;
    double sum = 0.0, cosine_sum = 0.0;

    for (int i = 0; i < count; i++) {
        double cos_theta = -1.0 + 2.0 * (i + 0.5) / count;

        sum += phase_rayleigh(cos_theta);
        cosine_sum += phase_rayleigh(cos_theta) * cos_theta;
    }
    // 1e-8: the midpoint rule on 20000 cells.
    assert_near(4.0 * M_PI * sum / count, 1.0, 1e-8);
    assert_near(4.0 * M_PI * cosine_sum / count, 0.0, 1e-8);
}

static void sideways_is_half_of_forwards(void **state)
{
    assert_near(phase_rayleigh(1.0), 2.0 * phase_rayleigh(0.0), 1e-16);
    assert_near(phase_rayleigh(-1.0), 2.0 * phase_rayleigh(0.0), 1e-16);
}

static void lobes_of_both_kinds_mix_by_weight(void **state)
{
    struct medium medium = {.lobes = {{.kind = SCENE_LOBE_RAYLEIGH, .g = 0.9, .weight = 0.25},
                                      {.kind = SCENE_LOBE_HENYEY_GREENSTEIN, .g = 0.6, .weight = 0.75}},
                            .lobe_count = 2};

    assert_near(medium_phase(&medium, 0.3), 0.25 * phase_rayleigh(0.3) + 0.75 * phase_henyey_greenstein(0.6, 0.3),
                1e-16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scatters_all_light_somewhere),
        cmocka_unit_test(sideways_is_half_of_forwards),
        cmocka_unit_test(lobes_of_both_kinds_mix_by_weight),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
