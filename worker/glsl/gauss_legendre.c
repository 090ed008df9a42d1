// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/gauss_legendre.h"

#include <assert.h>
#include <math.h>

// The Legendre polynomial of degree `count` and its derivative at x, by the three-term recurrence.
static double legendre(int count, double x, double *derivative)
{
    double before = 1, value = x;

    for (int k = 2; k <= count; ++k) {
        double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;

        before = value;
        value = next;
    }
    *derivative = count * (x * value - before) / (x * x - 1);
    return value;
}

void gauss_legendre(int count, double *points, double *weights)
{
    const double pi = 3.14159265358979323846;

    assert(count >= 1 && count <= GAUSS_LEGENDRE_LIMIT);
    for (int i = 0; i < count; ++i) {
        double x = -cos(pi * (i + 0.75) / (count + 0.5)), slope = 1;

        // Newton's method doubles the digits from this start; eight iterations have all of them.
        for (int iteration = 0; iteration < 8; ++iteration)
            x -= legendre(count, x, &slope) / slope;
        points[i] = 0.5 + 0.5 * x;
        weights[i] = 1 / ((1 - x * x) * slope * slope);
    }
}

// The polynomial that is 1 at point k and 0 at the others.
static double lagrange(const double *points, int count, int k, double x)
{
    double product = 1;

    for (int i = 0; i < count; ++i)
        if (i != k) product *= (x - points[i]) / (points[k] - points[i]);
    return product;
}

void gauss_legendre_partials(int count, double *partials)
{
    double points[GAUSS_LEGENDRE_PARTIAL_LIMIT], weights[GAUSS_LEGENDRE_PARTIAL_LIMIT];

    assert(count <= GAUSS_LEGENDRE_PARTIAL_LIMIT);
    gauss_legendre(count, points, weights);
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < count; ++k) {
            partials[i * count + k] = 0;
            for (int n = 0; n < count; ++n)
                partials[i * count + k] += points[i] * weights[n] * lagrange(points, count, k, points[i] * points[n]);
        }
}
