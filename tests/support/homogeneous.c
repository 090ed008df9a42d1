// SPDX-License-Identifier: Apache-2.0
#include "tests/support/homogeneous.h"

#include <math.h>

static double sphere_at(const void *field, struct vec3 position)
{
    const struct homogeneous_sphere *sphere = field;

    return vec3_length(position) <= sphere->radius ? 1.0 : 0.0;
}

static void sphere_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    const struct homogeneous_sphere *sphere = field;
    double middle = -vec3_dot(ray->origin, ray->direction);
    struct vec3 nearest = ray_at(ray, middle);
    double square = sphere->radius * sphere->radius - vec3_dot(nearest, nearest);

    if (square <= 0.0) return;
    span_list_append(spans, fmax(near, middle - sqrt(square)), fmin(far, middle + sqrt(square)), NULL);
}

static double box_at(const void *field, struct vec3 position)
{
    const struct homogeneous_box *box = field;

    return fabs(position.x) <= box->half_x && fabs(position.y) <= box->half_y && fabs(position.z) <= box->half_z ? 1.0
                                                                                                                 : 0.0;
}

static void cut_to_slab(double origin, double direction, double half, double *near, double *far)
{
    double a = (-half - origin) / direction, b = (half - origin) / direction;

    if (isinf(half)) return;
    if (direction == 0.0) {
        if (fabs(origin) > half) *far = *near;
        return;
    }
    *near = fmax(*near, fmin(a, b));
    *far = fmin(*far, fmax(a, b));
}

static void box_spans(const void *field, const struct ray *ray, double near, double far, struct span_list *spans)
{
    const struct homogeneous_box *box = field;

    cut_to_slab(ray->origin.x, ray->direction.x, box->half_x, &near, &far);
    cut_to_slab(ray->origin.y, ray->direction.y, box->half_y, &near, &far);
    cut_to_slab(ray->origin.z, ray->direction.z, box->half_z, &near, &far);
    span_list_append(spans, near, far, NULL);
}

struct density homogeneous_sphere_density(const struct homogeneous_sphere *sphere)
{
    return (struct density){.field = sphere, .at = sphere_at, .spans = sphere_spans};
}

struct density homogeneous_box_density(const struct homogeneous_box *box)
{
    return (struct density){.field = box, .at = box_at, .spans = box_spans};
}
