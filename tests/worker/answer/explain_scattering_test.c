// SPDX-License-Identifier: Apache-2.0
#include "worker/answer/explain_scattering.h"

#include "core/job/job.h"
#include "core/job/job_beyond.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void assert_says(int orders, const struct job_beyond *beyond, bool is_modelled, const char *expected)
{
    struct job job = {.scene.orders = orders,
                      .quality = {.method = JOB_METHOD_MIDPOINT, .scatter_grid = 8, .paths = 5}};
    char why[EXPLAIN_SCATTERING_SIZE];

    assert_int_equal(explain_scattering(&job, beyond, why), is_modelled);
    assert_string_equal(why, expected);
}

static void what_is_left_out_is_told(void **state)
{
    const struct job_beyond known = {.is_known = true, .error = 0.652, .error95 = 0.68};
    const struct job_beyond unknown = {.why = "measuring it takes too much work"}, nothing = {0};

    assert_says(1, &known, false,
                "light is scattered once at most; single scattering leaves out 65 % of the picture's light, at most "
                "68 %; scene.scattering.orders \"all\" models it");
    assert_says(1, &unknown, false,
                "light is scattered once at most; how much light single scattering leaves out is not known: measuring "
                "it takes too much work");
    assert_says(1, &nothing, false, "light is scattered once at most");
    assert_says(2, &known, true,
                "light is scattered up to 2 times; beyond once by a grid of 8 cells, 5 random paths a node; 2 orders "
                "of scattering leave out 65 % of the picture's light, at most 68 %; scene.scattering.orders \"all\" "
                "models it");
    assert_says(SCENE_ORDERS_ALL, &nothing, true,
                "light is scattered any number of times, by all orders; beyond once by a grid of 8 cells, 5 random "
                "paths a node");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_left_out_is_told),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
