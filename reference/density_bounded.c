// SPDX-License-Identifier: Apache-2.0
#include "reference/density_bounded.h"

#include <math.h>

static double at(const void *field, struct vec3 position)
{
    const struct density_bounded *bounded = field;
    double weight = bounds_weight(&bounded->bounds, position);

    return weight > 0.0 ? weight * bounded->inner.at(bounded->inner.field, position) : 0.0;
}

static void at_many(const void *field, size_t count, const struct vec3 *positions, double *densities)
{
    const struct density_bounded *bounded = field;

    density_at_many(&bounded->inner, count, positions, densities);
    for (size_t i = 0; i < count; i++) {
        double weight = bounds_weight(&bounded->bounds, positions[i]);

        densities[i] = weight > 0.0 ? weight * densities[i] : 0.0;
    }
}

static double at_image(const void *field, struct vec3 image)
{
    const struct density_bounded *bounded = field;

    return bounded->inner.at_image(bounded->inner.field, image);
}

static void find_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    const struct density_bounded *bounded = field;

    if (!bounds_clip(&bounded->bounds, ray, &near, &far)) return;
    bounded->inner.spans(bounded->inner.field, ray, near, far, spans);
    bounds_split(&bounded->bounds, ray, spans);
}

static void find_rough_spans(const void *field, const struct ray *ray, double near, double far, double tolerance,
                             struct span_list *spans)
{
    const struct density_bounded *bounded = field;

    if (!bounds_clip(&bounded->bounds, ray, &near, &far)) return;
    density_rough_spans(&bounded->inner, ray, near, far, tolerance, spans);
    bounds_split(&bounded->bounds, ray, spans);
}

static double find_column(const void *field, const struct ray *ray, double near, double far)
{
    const struct density_bounded *bounded = field;

    if (!bounds_clip(&bounded->bounds, ray, &near, &far)) return 0.0;
    return bounded->inner.column(bounded->inner.field, ray, near, far);
}

static double find_reach(const void *field, const struct ray *ray)
{
    const struct density_bounded *bounded = field;
    double near = -INFINITY, far = INFINITY;

    if (!bounds_clip(&bounded->bounds, ray, &near, &far)) return -INFINITY;
    return fmin(far, bounded->inner.reach(bounded->inner.field, ray));
}

static double find_most(const void *field, const struct box *box)
{
    const struct density_bounded *bounded = field;
    double weight = bounds_most(&bounded->bounds, box);

    return weight > 0.0 ? weight * bounded->inner.most(bounded->inner.field, box) : 0.0;
}

static double shared_half(double *center, double half, double other_center, double other_half)
{
    double low = fmax(*center - half, other_center - other_half);
    double high = fmin(*center + half, other_center + other_half);

    *center = 0.5 * (low + high);
    return fmax(0.5 * (high - low), 0.0);
}

static void intersect(struct box *box, const struct box *other)
{
    box->half.x = shared_half(&box->center.x, box->half.x, other->center.x, other->half.x);
    box->half.y = shared_half(&box->center.y, box->half.y, other->center.y, other->half.y);
    box->half.z = shared_half(&box->center.z, box->half.z, other->center.z, other->half.z);
}

static bool find_extent(const void *field, struct box *box)
{
    const struct density_bounded *bounded = field;
    const struct density *inner = &bounded->inner;
    struct box own;

    if (!inner->extent || !inner->extent(inner->field, &own)) return bounds_extent(&bounded->bounds, box);
    if (bounds_extent(&bounded->bounds, box)) {
        intersect(box, &own);
    } else {
        *box = own;
    }
    return true;
}

static bool clip(const void *field, const struct ray *ray, double *near, double *far)
{
    const struct density_bounded *bounded = field;
    const struct density *inner = &bounded->inner;

    return bounds_clip(&bounded->bounds, ray, near, far) && (!inner->clip || inner->clip(inner->field, ray, near, far));
}

struct density density_bounded(const struct density_bounded *field)
{
    const struct density *inner = &field->inner;
    bool is_even = field->bounds.falloff == 0.0;

    return (struct density){.field = field,
                            .at = at,
                            .at_many = inner->at_many ? at_many : NULL,
                            .at_image = inner->at_image && is_even ? at_image : NULL,
                            .spans = find_spans,
                            .rough_spans = inner->rough_spans ? find_rough_spans : NULL,
                            .column = inner->column && is_even ? find_column : NULL,
                            .reach = inner->reach ? find_reach : NULL,
                            .most = inner->most ? find_most : NULL,
                            .extent = find_extent,
                            .clip = clip};
}
