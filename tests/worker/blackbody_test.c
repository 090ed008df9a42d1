#include "worker/blackbody.h"

#include "reference/blackbody.h"
#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const double coldest_kelvin = 400;

// Entries by the reference's integral, which has other steps, another rule and another way to Rec. 709: floats and the
// rule's steps of 1 nm stay below 1e-5 of the luminance.
static void entries_are_the_reference_s_light(void **state)
{
    static float table[BLACKBODY_TABLE_SIZE][4];

    blackbody_fill_table(table);
    for (int i = 1; i < BLACKBODY_TABLE_SIZE - 1; i += 10) {
        double kelvin = coldest_kelvin * (BLACKBODY_TABLE_SIZE - 1) / i, rgb[3], xyz[3];
        double luminance = kelvin * exp2((double)table[i][3]);

        blackbody_rgb(kelvin, rgb);
        blackbody_xyz(kelvin, xyz);
        assert_near(luminance / xyz[1], 1, 1e-5);
        for (int k = 0; k < 3; ++k)
            assert_near(fmax((double)table[i][k], 0), rgb[k] / xyz[1], 1e-5);
    }
}

static void an_infinite_temperature_has_a_finite_entry(void **state)
{
    static float table[BLACKBODY_TABLE_SIZE][4];

    blackbody_fill_table(table);
    for (int k = 0; k < 4; ++k)
        assert_near((double)table[0][k], (double)table[1][k], 0.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(entries_are_the_reference_s_light),
        cmocka_unit_test(an_infinite_temperature_has_a_finite_entry),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
