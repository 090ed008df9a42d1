// The light of a black body.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// CIE 1931 tristimulus values of its radiance, scaled to Y = 1 at 1500 K. `kelvin` > 0.
void blackbody_xyz(double kelvin, double xyz[static 3]);
// The same in linear Rec. 709, clipped to 0 outside its gamut. Any `kelvin`; 0 for 400 and less, where the light is
// below 1e-18 of that at 1500 K.
void blackbody_rgb(double kelvin, double rgb[static 3]);
// Linear Rec. 709, clipped to 0 outside its gamut.
void blackbody_xyz_to_rgb(const double xyz[static 3], double rgb[static 3]);
