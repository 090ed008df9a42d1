// A density limited to a region.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/bounds.h"
#include "reference/density.h"

struct density_bounded {
    struct density inner;
    struct bounds bounds;
};

struct density density_bounded(const struct density_bounded *field); // borrows the field
