// Gauss' rule of three nodes within Kronrod's rule of seven. Kronrod, Nodes and Weights of Quadrature Formulas, 1965.
// SPDX-License-Identifier: Apache-2.0
// They are exact up to the fifth and the eleventh power. A cell is looked at by Gauss' nodes first; the others of
// Kronrod's are added where that is not exact enough.
#pragma once

enum { GAUSS_NODES = 3, KRONROD_NODES = 7 };

// In [0, 1]; the first GAUSS_NODES are Gauss'.
extern const double kronrod_nodes[KRONROD_NODES];

// The least error of Gauss' rule that is believed, relative to the integral: an estimate may be small by accident.
static const double GAUSS_LEAST_ERROR = 0.1;

// `count` is GAUSS_NODES or KRONROD_NODES in all functions.

// The weights of the integral from 0 to 1.
const double *kronrod_weights(int count);
// The weights of the integral from 0 to a node, of the polynomial through all nodes.
const double *kronrod_partial_weights(int count, int node);
// The integral of a function with these values at the nodes, over a cell. `error` is estimated by rules of fewer nodes,
// whose own error it is.
double kronrod_integrate(const double *values, int count, double length, double *error);
