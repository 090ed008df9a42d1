// Where along a ray the shadows of objects begin and end, which no quadrature should step over.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/light.h"
#include "reference/objects.h"
#include "reference/span_list.h"

// Splits the spans where the straight way to the light touches a shape, passes an edge of one, or passes where the
// boundaries of two meet: elsewhere the order of what it crosses stays the same.
void shadow_edges_split(const struct objects *objects, const struct light *light, const struct ray *ray,
                        struct span_list *spans);
