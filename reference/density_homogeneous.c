// SPDX-License-Identifier: Apache-2.0
#include "reference/density_homogeneous.h"

#include <math.h>

static double scale_of(const void *field)
{
    return ((const struct density_homogeneous *)field)->scale;
}

static double at(const void *field, struct vec3 position)
{
    return scale_of(field);
}

static void find_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    if (scale_of(field) > 0.0) span_list_append(spans, near, far, NULL);
}

static double find_column(const void *field, const struct ray *ray, double near, double far)
{
    double scale = scale_of(field);

    return scale > 0.0 ? scale * (far - near) : 0.0;
}

static double find_reach(const void *field, const struct ray *ray)
{
    return scale_of(field) > 0.0 ? INFINITY : 0.0;
}

static double find_most(const void *field, const struct box *box)
{
    return scale_of(field);
}

struct density density_homogeneous(const struct density_homogeneous *field)
{
    return (struct density){
        .field = field, .at = at, .spans = find_spans, .column = find_column, .reach = find_reach, .most = find_most};
}
