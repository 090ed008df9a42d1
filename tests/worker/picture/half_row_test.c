// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/half_row.h"

#include "tests/support/random.h"

#define IMATH_HALF_NO_LOOKUP_TABLE
#include <Imath/half.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { COUNT = 1021 }; // no multiple of the width of vector instructions

static float float_of_bits(uint32_t bits)
{
    float value;

    memcpy(&value, &bits, sizeof value);
    return value;
}

// Checks a half's value, the floats next to it, and the middle to the next half with its neighbours.
static float value_near_half(uint32_t index)
{
    static const int32_t offsets[] = {-1, 0, 1, 0x0fff, 0x1000, 0x1001};
    float half = imath_half_to_float((uint16_t)(index / 6));
    uint32_t bits;

    memcpy(&bits, &half, sizeof bits);
    return float_of_bits(bits + (uint32_t)offsets[index % 6]);
}

static void assert_row(const float *values, size_t count)
{
    uint16_t halves[HALF_ROW_PLANES * COUNT + 1];
    uint16_t *const planes[] = {halves, halves + count, halves + 2 * count, halves + 3 * count};

    halves[HALF_ROW_PLANES * count] = 0x1234;
    half_row_split(planes, values, count);
    for (size_t i = 0; i < HALF_ROW_PLANES * count; i++) {
        uint16_t expected = imath_float_to_half(values[i]),
                 got = halves[i % HALF_ROW_PLANES * count + i / HALF_ROW_PLANES];
        // Any NaN is right.
        if ((expected & 0x7fff) > 0x7c00 ? (got & 0x7fff) <= 0x7c00 : got != expected)
            fail_msg("%a: expected 0x%04x, got 0x%04x", (double)values[i], expected, got);
    }
    assert_int_equal(halves[HALF_ROW_PLANES * count], 0x1234);
}

static void every_half_and_what_is_between_is_rounded_to_nearest_even(void **state)
{
    float values[HALF_ROW_PLANES * COUNT] = {0};

    for (uint32_t first = 0; first < 6 * 65536; first += HALF_ROW_PLANES * COUNT) {
        for (uint32_t i = 0; i < HALF_ROW_PLANES * COUNT; i++)
            values[i] = value_near_half((first + i) % (6 * 65536));
        assert_row(values, COUNT);
    }
}

static void any_float_is_rounded_whatever_the_length(void **state)
{
    struct random random = {5};
    float values[HALF_ROW_PLANES * 67] = {0};

    for (size_t count = 0; count <= 67; count++) {
        for (size_t i = 0; i < HALF_ROW_PLANES * count; i++)
            values[i] = float_of_bits((uint32_t)random_between(&random, 0, 4294967295.0));
        assert_row(values, count);
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_half_and_what_is_between_is_rounded_to_nearest_even),
        cmocka_unit_test(any_float_is_rounded_whatever_the_length),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
