// Stretches of a ray on which a function is smooth: ascending and disjoint.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/vec3.h"

#include <stddef.h>

struct span {
    double begin, end; // m along the ray, begin < end; end may be INFINITY
    struct ray image;  // the ray as a field that folds space maps it on this stretch; a merge loses it
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
// Makes `list` the union of itself and `other`, split at the ends of both, except for slivers due to rounding.
void span_list_merge(struct span_list *list, const struct span_list *other);
void span_list_finish(struct span_list *list); // leaves it empty
