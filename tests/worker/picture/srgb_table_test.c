// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/srgb_table.h"

#include "worker/picture/srgb.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static void assert_same(const struct srgb_table *table, float value)
{
    if (srgb_table_encode(table, value) != srgb_encode_byte(value))
        fail_msg("%.9g: %d, not %d", (double)value, srgb_table_encode(table, value), srgb_encode_byte(value));
}

// Each 97th float, what surrounds each byte's least value, and what is no light.
static void bytes_are_those_of_the_formula(void **state)
{
    static const float odd[] = {0.0f, -0.0f, -1.0f, 1.0f, 1e30f, 1e-45f, INFINITY, -INFINITY, NAN};
    struct srgb_table table;

    (void)state;
    srgb_table_init(&table);
    for (uint32_t bits = 0; bits < 0x40000000; bits += 97) {
        float value;

        memcpy(&value, &bits, sizeof value);
        assert_same(&table, value);
    }
    for (int byte = 1; byte < 256; byte++) {
        assert_same(&table, table.from[byte]);
        assert_same(&table, nextafterf(table.from[byte], 0.0f));
    }
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
        assert_same(&table, odd[i]);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(bytes_are_those_of_the_formula)};

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
