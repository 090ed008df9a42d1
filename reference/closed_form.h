// Integrals in closed form, by which the integrators are checked.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Transmittance of `length` metres, by Beer-Lambert.
double closed_form_transmittance(double sigma_t, double length);
// Length inside a sphere of a line that passes its centre at distance `offset`; 0 when it misses.
double closed_form_sphere_chord(double radius, double offset);
// Length inside a slab of `thickness` of a line at `cos_normal` to its normal.
double closed_form_slab_length(double thickness, double cos_normal);

// Radiance of a glowing absorbing slab before a background: source per metre `emission`.
double closed_form_emission_slab(double emission, double sigma_a, double length, double background);

// The integral of max(radius - r, 0)^exponent over a whole line that passes the origin at `offset`; exponent 1 or 2.
double closed_form_cone_column(double radius, double offset, int exponent);

// The integral of a density that changes evenly from `first` to `last`, both >= 0, over `length` metres.
double closed_form_ramp_column(double first, double last, double length);

// Single scattering in a homogeneous slab seen along its normal. `sun` is the irradiance at normal incidence. The first
// is for light that enters at the near face and is scattered back, the second for light that comes through the slab.
double closed_form_front_lit_slab(double sigma_s, double sigma_t, double length, double phase, double sun);
double closed_form_back_lit_slab(double sigma_s, double sigma_t, double length, double phase, double sun);

// The integral of 1 / (height^2 + (t - foot)^2) over t from near to far: inverse-square light beside a ray.
double closed_form_inverse_square(double height, double foot, double near, double far);
