// Points and weights that integrate polynomials exactly.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum { GAUSS_LEGENDRE_LIMIT = 64 };

// Of `count` points in [1, GAUSS_LEGENDRE_LIMIT] on [0, 1], ascending: exact up to degree 2 count - 1.
void gauss_legendre(int count, double *points, double *weights);
// Of the same points: partials[i * count + k] is what the value at point k weighs in the integral from 0 to point i, exact
// up to degree count - 1. `count` is at most GAUSS_LEGENDRE_PARTIAL_LIMIT.
enum { GAUSS_LEGENDRE_PARTIAL_LIMIT = 8 };
void gauss_legendre_partials(int count, double *partials);
