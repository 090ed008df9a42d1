// Scattering by particles far smaller than the wavelength: 3 / (16 pi) (1 + cos^2), normalised over the sphere.
// SPDX-License-Identifier: Apache-2.0
#pragma once

double phase_rayleigh(double cos_theta); // between the directions of travel before and after
