// The colour of a diffuse surface where a ray meets it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/objects.h"

// The albedo of the object that fills `region`, at a position on the boundary of the shape `shape`, which may be that
// of another object that ends there.
void surface_find_albedo(const struct objects *objects, size_t region, size_t shape, struct vec3 position,
                         double albedo[static 3]);
