// Which cells of an integral to refine next, by estimates of their errors.
// SPDX-License-Identifier: Apache-2.0
// The errors of cells count as independent: their squares add.
#pragma once

#include <stddef.h>

// The errors of cells, each a member of a cell in an array.
struct refinement {
    const double *errors; // the first cell's; borrowed
    size_t stride_bytes;  // from one cell's to the next one's
    size_t count;
};

double refinement_error(const struct refinement *cells); // of the sum of all cells
// The error above which cells are to be refined, so that the others keep within most of what is allowed.
double refinement_limit(const struct refinement *cells, double allowed);
// Raises the errors of a cell's two halves to what the halving's change lets expect: their own estimates may be small
// by accident.
void refinement_doubt(double *first, double *second, double change);
