// Polynomials of the third degree on [0, 1]: c[0] + c[1] s + c[2] s^2 + c[3] s^3.
// SPDX-License-Identifier: Apache-2.0
#pragma once

double cubic_at(const double c[static 4], double s);
// The integral over [begin, end].
double cubic_integral(const double c[static 4], double begin, double end);
// Finds the points in (0, 1) where it passes `level`, ascending, and returns their number.
int cubic_find_crossings(const double c[static 4], double level, double crossings[static 3]);
