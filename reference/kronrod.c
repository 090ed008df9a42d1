// SPDX-License-Identifier: Apache-2.0
#include "reference/kronrod.h"

#include <math.h>

#define SQRT_15 3.8729833462074170

const double kronrod_nodes[KRONROD_NODES] = {
    0.5 - SQRT_15 / 10.0, 0.5,
    0.5 + SQRT_15 / 10.0, //
    0.019754365645989858, 0.28287812532659872,
    0.71712187467340128,  0.98024563435401014,
};

static const double GAUSS[GAUSS_NODES] = {5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0};
static const double KRONROD[KRONROD_NODES] = {
    0.13424404493416672,  0.22545826932923707, 0.13424404493416672, //
    0.052328113013233633, 0.20069870738798111, 0.20069870738798111, 0.052328113013233633,
};
// Without Gauss' outer nodes; exact up to the fifth power, too.
static const double INNER[KRONROD_NODES] = {
    0.0,
    0.020645161290322581,
    0.0, //
    0.1012694832089254,
    0.38840793614591331,
    0.38840793614591331,
    0.1012694832089254,
};

// Row i has the weights of the integral from 0 to node i. Butcher, Mathematics of Computation 18, 1964.
static const double GAUSS_PARTIAL[GAUSS_NODES][GAUSS_NODES] = {
    {5.0 / 36.0, 2.0 / 9.0 - SQRT_15 / 15.0, 5.0 / 36.0 - SQRT_15 / 30.0},
    {5.0 / 36.0 + SQRT_15 / 24.0, 2.0 / 9.0, 5.0 / 36.0 - SQRT_15 / 24.0},
    {5.0 / 36.0 + SQRT_15 / 30.0, 2.0 / 9.0 + SQRT_15 / 15.0, 5.0 / 36.0},
};
// The integrals of the polynomials that are 1 at one node and 0 at the others.
static const double KRONROD_PARTIAL[KRONROD_NODES][KRONROD_NODES] = {
    {0.062180655738885225, 0.0066281907133648297, 0.00226034506007855, 0.058904120091671882, -0.012527431788942512,
     -0.004005308577993829, -0.0007389058578058355},
    {0.12580855123869157, 0.11272913466461854, 0.0084354936954751459, 0.05485432833823863, 0.22006288963142652,
     -0.019364182243445405, -0.0025262153250049974},
    {0.13198369987408817, 0.21883007861587224, 0.072063389195281495, 0.053067018871039468, 0.20470401596597494,
     0.21322613917692362, -0.0065760070784382498},
    {-0.006518045402827166, -0.0021411594439468144, -0.00078648841285564366, 0.024074822784324866,
     0.0035028854846705259, 0.0013629822970230769, 0.00025936833960101305},
    {0.14983586468668427, -0.017800243803089004, -0.0047097669834031764, 0.048381018174025479, 0.096726617725864283,
     0.0089445866924711892, 0.0015000488340456843},
    {0.1389538119175699, 0.24325851313232608, -0.015591819752517545, 0.050828064179187948, 0.19175412069550992,
     0.10397208966211683, 0.0039470948392081534},
    {0.13503053334702236, 0.22759942877318389, 0.14076209033699389, 0.05206874467363262, 0.19933572509095803,
     0.19719582190331059, 0.028253290228908766},
};

const double *kronrod_weights(int count)
{
    return count == GAUSS_NODES ? GAUSS : KRONROD;
}

const double *kronrod_partial_weights(int count, int node)
{
    return count == GAUSS_NODES ? GAUSS_PARTIAL[node] : KRONROD_PARTIAL[node];
}

static double weigh(const double *weights, const double *values, int count)
{
    double sum = 0.0;

    for (int i = 0; i < count; i++)
        sum += weights[i] * values[i];
    return sum;
}

double kronrod_integrate(const double *values, int count, double length, double *error)
{
    double gauss = weigh(GAUSS, values, GAUSS_NODES), kronrod;

    if (count == GAUSS_NODES) {
        *error = length * fmax(fabs(gauss - 0.5 * (values[0] + values[2])), GAUSS_LEAST_ERROR * fabs(gauss));
        return length * gauss;
    }
    kronrod = weigh(KRONROD, values, KRONROD_NODES);
    // Two rules, because one alone may agree by accident.
    *error = length * fmax(fabs(kronrod - gauss), fabs(kronrod - weigh(INNER, values, KRONROD_NODES)));
    return length * kronrod;
}
