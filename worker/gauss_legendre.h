// Points and weights that integrate polynomials exactly.
#pragma once

enum { GAUSS_LEGENDRE_LIMIT = 64 };

// Of `count` points in [1, GAUSS_LEGENDRE_LIMIT] on [0, 1], ascending: exact up to degree 2 count - 1.
void gauss_legendre(int count, double *points, double *weights);
