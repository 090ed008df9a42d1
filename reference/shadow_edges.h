// The distances along a ray where objects' shadows begin and end, which a quadrature must not step over.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/light.h"
#include "reference/objects.h"
#include "reference/span_list.h"

// Splits the spans where the shadow ray touches a shape, or passes an edge of a shape or of the intersection of two.
// Between the splits it crosses the same boundaries in the same order.
void shadow_edges_split(const struct objects *objects, const struct light *light, const struct ray *ray,
                        struct span_list *spans);
