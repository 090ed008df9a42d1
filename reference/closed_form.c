// SPDX-License-Identifier: Apache-2.0
#include "reference/closed_form.h"

#include <math.h>

double closed_form_transmittance(double sigma_t, double length)
{
    return exp(-sigma_t * length);
}

double closed_form_sphere_chord(double radius, double offset)
{
    return fabs(offset) < radius ? 2.0 * sqrt(radius * radius - offset * offset) : 0.0;
}

double closed_form_slab_length(double thickness, double cos_normal)
{
    return thickness / fabs(cos_normal);
}

double closed_form_emission_slab(double emission, double sigma_a, double length, double background)
{
    double depth = sigma_a * length;

    if (sigma_a == 0.0) return emission * length + background;
    return -emission / sigma_a * expm1(-depth) + background * exp(-depth);
}

double closed_form_cone_column(double radius, double offset, int exponent)
{
    double half = 0.5 * closed_form_sphere_chord(radius, offset);
    double squared = offset * offset;
    double turn = offset != 0.0 ? squared * asinh(half / fabs(offset)) : 0.0;

    if (exponent == 1) return radius * half - turn;
    return 2.0 * (squared * half + half * half * half / 3.0 - radius * turn);
}

double closed_form_ramp_column(double first, double last, double length)
{
    return 0.5 * (first + last) * length;
}

double closed_form_front_lit_slab(double sigma_s, double sigma_t, double length, double phase, double sun)
{
    return -sigma_s * phase * sun * expm1(-2.0 * sigma_t * length) / (2.0 * sigma_t);
}

double closed_form_back_lit_slab(double sigma_s, double sigma_t, double length, double phase, double sun)
{
    return sigma_s * phase * sun * length * exp(-sigma_t * length);
}

double closed_form_inverse_square(double height, double foot, double near, double far)
{
    return (atan((far - foot) / height) - atan((near - foot) / height)) / height;
}
