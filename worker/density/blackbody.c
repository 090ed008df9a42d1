// SPDX-License-Identifier: Apache-2.0
#include "worker/density/blackbody.h"

#include <math.h>

static const double coldest_kelvin = 400, norm_kelvin = 1500;
static const double second_constant = 0.014387768775; // h c / k, m K
static const double first_nm = 360, last_nm = 830, step_nm = 1;

// The CIE 1931 observer as fitted by Wyman, Sloan and Shirley, Journal of Computer Graphics Techniques 2(2), 2013: sums
// of Gaussians that are wider on one side than on the other.
static const struct lobe {
    int component;
    double height, center, width_below, width_above; // nm
} lobes[] = {
    {0, 1.056, 599.8, 37.9, 31.0}, {0, 0.362, 442.0, 16.0, 26.7}, {0, -0.065, 501.1, 20.4, 26.2},
    {1, 0.821, 568.8, 46.9, 40.5}, {1, 0.286, 530.9, 16.3, 31.1}, {2, 1.217, 437.0, 11.8, 36.0},
    {2, 0.681, 459.0, 26.0, 13.8},
};

static const double rec709_of_xyz[3][3] = {
    {3.2409699419045226, -1.5373831775700940, -0.4986107602930034},
    {-0.9692436362808796, 1.8759675015077202, 0.0415550574071756},
    {0.0556300796969937, -0.2039769588889765, 1.0569715142428786},
};

// Planck's radiance divided by the temperature, without its constant factor, which cancels. It is finite for an
// infinite temperature too.
static double planck_by_kelvin(double wavelength_nm, double inverse_kelvin)
{
    double wavelength = 1e-9 * wavelength_nm;
    double exponent = second_constant * inverse_kelvin / wavelength;

    return pow(wavelength, -4) * (exponent > 0 ? exponent / expm1(exponent) : 1);
}

static void integrate(double inverse_kelvin, double xyz[static 3])
{
    xyz[0] = xyz[1] = xyz[2] = 0;
    for (int step = 0; first_nm + step * step_nm <= last_nm; ++step) {
        double at = first_nm + step * step_nm;
        double weight = at == first_nm || at == last_nm ? 0.5 : 1;
        double radiance = weight * planck_by_kelvin(at, inverse_kelvin);

        for (size_t i = 0; i < sizeof lobes / sizeof *lobes; ++i) {
            const struct lobe *lobe = &lobes[i];
            double offset = (at - lobe->center) / (at < lobe->center ? lobe->width_below : lobe->width_above);

            xyz[lobe->component] += radiance * lobe->height * exp(-0.5 * offset * offset);
        }
    }
}

void blackbody_fill_table(float table[static BLACKBODY_TABLE_SIZE][4])
{
    double norm[3];

    integrate(1 / norm_kelvin, norm);
    for (int i = 0; i < BLACKBODY_TABLE_SIZE; ++i) {
        double xyz[3];

        integrate(i / (BLACKBODY_TABLE_SIZE - 1.0) / coldest_kelvin, xyz);
        for (int row = 0; row < 3; ++row) {
            const double *m = rec709_of_xyz[row];

            table[i][row] = (float)((m[0] * xyz[0] + m[1] * xyz[1] + m[2] * xyz[2]) / xyz[1]);
        }
        table[i][3] = (float)log2(xyz[1] / (norm[1] * norm_kelvin));
    }
}
