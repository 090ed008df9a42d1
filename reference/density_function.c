// SPDX-License-Identifier: Apache-2.0
#include "reference/density_function.h"

#include <math.h>

static double at(const void *field, struct vec3 position)
{
    const struct density_function *function = field;

    return function->scale * fmax(function->at(function->context, position, function->time), 0.0);
}

// Pieces so short that hardly a feature hides between their nodes: where the function is smooth or positive is not
// known.
static void find_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    const int pieces = 64;

    for (int i = 0; i < pieces; i++) {
        double begin = near + (far - near) * i / pieces, end = near + (far - near) * (i + 1) / pieces;

        span_list_append(spans, begin, end, NULL);
    }
}

static double find_reach(const void *field, const struct ray *ray)
{
    return INFINITY;
}

static double find_most(const void *field, const struct box *box)
{
    const struct density_function *function = field;

    return function->scale * function->majorant;
}

struct density density_function(const struct density_function *field)
{
    return (struct density){.field = field,
                            .at = at,
                            .spans = find_spans,
                            .reach = find_reach,
                            .most = field->majorant > 0.0 ? find_most : NULL};
}
