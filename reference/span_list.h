// Stretches of a ray, ascending and apart, on which something is smooth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"

#include <stddef.h>

struct span {
    double begin, end; // m along the ray, begin < end; end may be INFINITY
    struct ray image;  // where a field that folds space puts the ray on this stretch; lost by a merge
};

// The zero value is empty.
struct span_list {
    size_t count, capacity;
    struct span *spans; // owned
};

// Empty spans are dropped.
void span_list_append(struct span_list *list, double begin, double end, const struct ray *image); // NULL: none
// Splits the span that contains `cut`, if one does.
void span_list_split(struct span_list *list, double cut);
// Splits at each end of `other`'s spans.
void span_list_split_at_ends(struct span_list *list, const struct span_list *other);
// Makes `list` the union of itself and `other`, with the ends of both as ends, but for slivers that roundings leave.
void span_list_merge(struct span_list *list, const struct span_list *other);
void span_list_finish(struct span_list *list); // leaves it empty
