// SPDX-License-Identifier: Apache-2.0
#include "reference/blackbody.h"

#include <math.h>

// One side's width below the peak, the other's above it.
static double bump(double x, double peak, double below, double above)
{
    double t = (x - peak) / (x < peak ? below : above);

    return exp(-t * t / 2);
}

// Wyman, Sloan, Shirley, Simple analytic approximations to the CIE XYZ color matching functions, JCGT 2(2), 2013.
static double match_x(double nm)
{
    return 1.056 * bump(nm, 599.8, 37.9, 31.0) + 0.362 * bump(nm, 442.0, 16.0, 26.7) -
           0.065 * bump(nm, 501.1, 20.4, 26.2);
}

static double match_y(double nm)
{
    return 0.821 * bump(nm, 568.8, 46.9, 40.5) + 0.286 * bump(nm, 530.9, 16.3, 31.1);
}

static double match_z(double nm)
{
    return 1.217 * bump(nm, 437.0, 11.8, 36.0) + 0.681 * bump(nm, 459.0, 26.0, 13.8);
}

// Planck's law per wavelength, in W / (m^2 sr m).
static double spectral_radiance(double metres, double kelvin)
{
    const double h = 6.62607015e-34, c = 299792458, k = 1.380649e-23;

    return 2 * h * c * c / pow(metres, 5) / expm1(h * c / (metres * k * kelvin));
}

// Simpson's rule over the range of the CIE's tables, 360 to 830 nm.
static double against(double kelvin, double match(double nm))
{
    const int panels = 4700;
    const double width = 470.0 / panels;
    double sum = 0;

    for (int i = 0; i <= panels; i++) {
        double nm = 360 + width * i;
        double weight = i == 0 || i == panels ? 1 : i % 2 ? 4 : 2;

        sum += weight * match(nm) * spectral_radiance(nm * 1e-9, kelvin);
    }
    return sum * width / 3;
}

void blackbody_xyz(double kelvin, double xyz[static 3])
{
    double unit = against(1500, match_y);

    xyz[0] = against(kelvin, match_x) / unit;
    xyz[1] = against(kelvin, match_y) / unit;
    xyz[2] = against(kelvin, match_z) / unit;
}

// Solves for the amounts of Rec. 709's primaries (x, y of red, green, blue; white D65) by Cramer's rule.
static double determinant(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static void amounts_of(const double xyz[3], double amounts[3])
{
    const double r[3] = {0.64, 0.33, 0.03}, g[3] = {0.30, 0.60, 0.10}, b[3] = {0.15, 0.06, 0.79};
    double whole = determinant(r, g, b);

    amounts[0] = determinant(xyz, g, b) / whole;
    amounts[1] = determinant(r, xyz, b) / whole;
    amounts[2] = determinant(r, g, xyz) / whole;
}

void blackbody_xyz_to_rgb(const double xyz[static 3], double rgb[static 3])
{
    const double white[3] = {0.3127 / 0.3290, 1, (1 - 0.3127 - 0.3290) / 0.3290};
    double of_white[3];

    amounts_of(xyz, rgb);
    amounts_of(white, of_white);
    for (int i = 0; i < 3; i++)
        rgb[i] = fmax(rgb[i] / of_white[i], 0);
}

void blackbody_rgb(double kelvin, double rgb[static 3])
{
    double xyz[3];

    rgb[0] = rgb[1] = rgb[2] = 0;
    if (!(kelvin > 400)) return;
    blackbody_xyz(kelvin, xyz);
    blackbody_xyz_to_rgb(xyz, rgb);
}
