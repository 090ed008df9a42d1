// Polynomials of the third degree on [0, 1]: c[0] + c[1] s + c[2] s^2 + c[3] s^3.
// SPDX-License-Identifier: Apache-2.0
#pragma once

double cubic_at(const double c[static 4], double s);
// Over [begin, end].
double cubic_integral(const double c[static 4], double begin, double end);
// Where in (0, 1) it passes `level`, ascending; returns how many times.
int cubic_find_crossings(const double c[static 4], double level, double crossings[static 3]);
