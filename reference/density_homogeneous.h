// The same density everywhere.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/density.h"

struct density_homogeneous {
    double scale;
};

struct density density_homogeneous(const struct density_homogeneous *field); // borrows the field
