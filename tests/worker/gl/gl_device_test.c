// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_device.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

// As EGL lists them: CUDA counts otherwise, and one device renders in software.
static const struct gl_device devices[] = {{.cuda_number = 1, .uuid = "11111111-0000-0000-0000-000000000000"},
                                           {.is_software = true, .cuda_number = -1},
                                           {.cuda_number = 0, .uuid = "22222222-0000-0000-0000-000000000000"},
                                           {.cuda_number = 2, .uuid = "3333aaaa-0000-0000-0000-000000000000"}};
enum { COUNT = sizeof devices / sizeof devices[0] };

// `expected` ends with -1.
static void assert_order(const struct gl_device *of, int turn, const char *visible, const int *expected)
{
    int order[COUNT];
    size_t count = gl_device_order(of, COUNT, turn, visible, order), i = 0;

    for (; expected[i] >= 0; i++) {
        assert_true(i < count);
        assert_int_equal(order[i], expected[i]);
    }
    assert_int_equal(count, i);
}

#define ORDER(...) ((const int[]){__VA_ARGS__, -1})

static void workers_begin_with_the_gpus_in_turn(void **state)
{
    assert_order(devices, 0, NULL, ORDER(0, 2, 3));
    assert_order(devices, 1, NULL, ORDER(2, 3, 0));
    assert_order(devices, 2, NULL, ORDER(3, 0, 2));
    assert_order(devices, 3, NULL, ORDER(0, 2, 3));
}

static void only_gpus_that_cuda_sees_are_tried(void **state)
{
    assert_order(devices, 0, "0", ORDER(2));
    assert_order(devices, 5, "0", ORDER(2));
    assert_order(devices, 0, "2,1", ORDER(3, 0));
    assert_order(devices, 1, "2,1", ORDER(0, 3));
    assert_order(devices, 0, "GPU-3333AAAA,GPU-1111", ORDER(3, 0));
    assert_order(devices, 0, "0,7", ORDER(2));
}

static void numbers_count_gpus_where_the_driver_tells_none(void **state)
{
    struct gl_device nameless[COUNT];

    memcpy(nameless, devices, sizeof nameless);
    for (size_t i = 0; i < COUNT; i++)
        nameless[i].cuda_number = -1;
    assert_order(nameless, 0, "2", ORDER(3));
    assert_order(nameless, 1, "1,0", ORDER(0, 2));
}

static void what_names_no_gpu_restricts_to_none_or_nothing(void **state)
{
    assert_order(devices, 0, "", (const int[]){-1});
    assert_order(devices, 0, "NoDevFiles", (const int[]){-1});
    assert_order(devices, 1, "9", ORDER(2, 3, 0));
    assert_order(devices, 0, "MIG-0,,,", ORDER(0, 2, 3));
    assert_order(devices, 0, "0,0,2,0,0,0", ORDER(2, 3));
}

static void a_turn_is_read(void **state)
{
    int turn;

    assert_true(gl_device_read_turn("turn:12", &turn));
    assert_int_equal(turn, 12);
    assert_false(gl_device_read_turn("turn:", &turn));
    assert_false(gl_device_read_turn("turn:-1", &turn));
    assert_false(gl_device_read_turn("turn:12345", &turn));
    assert_false(gl_device_read_turn("3", &turn));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(workers_begin_with_the_gpus_in_turn),
        cmocka_unit_test(only_gpus_that_cuda_sees_are_tried),
        cmocka_unit_test(numbers_count_gpus_where_the_driver_tells_none),
        cmocka_unit_test(what_names_no_gpu_restricts_to_none_or_nothing),
        cmocka_unit_test(a_turn_is_read),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
