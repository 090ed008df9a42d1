// SPDX-License-Identifier: Apache-2.0
#include "reference/blackbody.h"

#include "tests/support/assert_near.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

// The fit differs from the CIE's own tables by up to about this in x and y along the Planckian locus: most at 1500 K.
static const double fit = 0.005;

static void chromaticities_are_those_of_the_planckian_locus(void **state)
{
    static const double known[][3] = {{1500, 0.5857, 0.3931},
                                      {2856, 0.4476, 0.4074},
                                      {4000, 0.3805, 0.3768},
                                      {6500, 0.3135, 0.3237},
                                      {10000, 0.2807, 0.2884}};

    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        double xyz[3], sum;

        blackbody_xyz(known[i][0], xyz);
        sum = xyz[0] + xyz[1] + xyz[2];
        assert_near(xyz[0] / sum, known[i][1], fit);
        assert_near(xyz[1] / sum, known[i][2], fit);
    }
}

static void luminance_is_one_at_1500_kelvin_and_grows(void **state)
{
    double before = 0;

    for (double kelvin = 500; kelvin < 1e5; kelvin *= 1.1) {
        double xyz[3];

        blackbody_xyz(kelvin, xyz);
        assert_true(xyz[1] > before);
        before = xyz[1];
    }
    {
        double xyz[3];

        blackbody_xyz(1500, xyz);
        assert_near(xyz[1], 1, 1e-12);
    }
}

// d ln Y / d ln T is h c / (wavelength k T) at low temperatures, by Wien's law for an effective wavelength of 555 nm or
// more. It is 1 at temperatures so high that the law of Rayleigh and Jeans holds.
static void growth_follows_wien_and_rayleigh_and_jeans(void **state)
{
    double low[3], high[3];

    blackbody_xyz(1500, low);
    blackbody_xyz(1501, high);
    assert_near(log(high[1] / low[1]) / log(1501.0 / 1500) / (0.0143878 / (580e-9 * 1500)), 1, 0.05);
    blackbody_xyz(1e8, low);
    blackbody_xyz(2e8, high);
    assert_near(high[1] / low[1], 2, 1e-3);
}

static void the_white_point_of_rec_709_is_near_6500_kelvin(void **state)
{
    double rgb[3];

    blackbody_rgb(6504, rgb);
    // D65 lies off the locus by 0.005 in y, which these ratios show several times as large.
    assert_near(rgb[0] / rgb[1], 1, 0.08);
    assert_near(rgb[2] / rgb[1], 1, 0.08);
}

static void colours_outside_of_rec_709_are_clipped(void **state)
{
    double rgb[3];

    blackbody_rgb(1500, rgb);
    assert_true(rgb[0] > 2 && rgb[1] > 0.3 && rgb[1] < rgb[0]);
    assert_near(rgb[2], 0, 0);
    blackbody_rgb(400, rgb);
    assert_near(rgb[0], 0, 0);
    blackbody_rgb(-1, rgb);
    assert_near(rgb[0], 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chromaticities_are_those_of_the_planckian_locus),
        cmocka_unit_test(luminance_is_one_at_1500_kelvin_and_grows),
        cmocka_unit_test(growth_follows_wien_and_rayleigh_and_jeans),
        cmocka_unit_test(the_white_point_of_rec_709_is_near_6500_kelvin),
        cmocka_unit_test(colours_outside_of_rec_709_are_clipped),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
