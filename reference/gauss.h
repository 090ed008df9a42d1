// Gauss' rule of three nodes on [0, 1], exact up to the fifth power.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum { GAUSS_NODES = 3 };

#define GAUSS_SQRT_15 3.8729833462074170

static const double GAUSS_NODE[GAUSS_NODES] = {0.5 - GAUSS_SQRT_15 / 10.0, 0.5, 0.5 + GAUSS_SQRT_15 / 10.0};
static const double GAUSS_WEIGHT[GAUSS_NODES] = {5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0};
// Row i has the weights of the integral from 0 to node i. Butcher, Mathematics of Computation 18, 1964.
static const double GAUSS_PARTIAL[GAUSS_NODES][GAUSS_NODES] = {
    {5.0 / 36.0, 2.0 / 9.0 - GAUSS_SQRT_15 / 15.0, 5.0 / 36.0 - GAUSS_SQRT_15 / 30.0},
    {5.0 / 36.0 + GAUSS_SQRT_15 / 24.0, 2.0 / 9.0, 5.0 / 36.0 - GAUSS_SQRT_15 / 24.0},
    {5.0 / 36.0 + GAUSS_SQRT_15 / 30.0, 2.0 / 9.0 + GAUSS_SQRT_15 / 15.0, 5.0 / 36.0},
};
