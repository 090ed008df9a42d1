// Density from a grid's values: in proportion to them, or by a transfer function.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/density.h"
#include "reference/grid.h"
#include "reference/medium.h"
#include "reference/transfer_function.h"

struct density_grid {
    struct grid grid;
    double scale;      // density = scale max(value, 0)
    bool has_transfer; // density and glow are its extinction and colour
    struct transfer_function transfer;
};

// Spans end at every cell and where the value passes 0 or a point of the transfer function. Columns of densities in
// proportion are exact.
struct density density_grid(const struct density_grid *field);          // borrows the field
struct medium_glow density_grid_glow(const struct density_grid *field); // for a field with a transfer function
