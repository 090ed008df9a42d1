// Points and weights of Gauss-Legendre rules, which integrate polynomials exactly.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum { GAUSS_LEGENDRE_LIMIT = 64 };

// Computes `count` points, in [1, GAUSS_LEGENDRE_LIMIT], on [0, 1] in ascending order: exact up to degree 2 count - 1.
void gauss_legendre(int count, double *points, double *weights);
// Computes for the same points partials[i * count + k], the weight of the value at point k in the integral from 0 to
// point i: exact up to degree count - 1. `count` is at most GAUSS_LEGENDRE_PARTIAL_LIMIT.
enum { GAUSS_LEGENDRE_PARTIAL_LIMIT = 8 };
void gauss_legendre_partials(int count, double *partials);
