// SPDX-License-Identifier: Apache-2.0
#include "reference/shape.h"

#include <math.h>

// Tolerance, relative to the coordinates that take part: far above rounding errors, far below any size.
static const double TOUCH = 1e-11;

static double touch_distance(const struct shape *shape, struct vec3 origin)
{
    return TOUCH * (vec3_length(origin) + vec3_length(shape->center) + shape->radius + vec3_length(shape->half));
}

static bool cross_sphere(const struct shape *sphere, const struct ray *ray, double touch, double *begin, double *end)
{
    struct vec3 offset = vec3_subtract(ray->origin, sphere->center);
    double along = vec3_dot(offset, ray->direction);
    struct vec3 nearest = vec3_subtract(offset, vec3_scale(ray->direction, along));
    double square = sphere->radius * sphere->radius - vec3_dot(nearest, nearest);

    if (fabs(vec3_length(offset) - sphere->radius) <= touch) {
        *begin = 0.0;
        *end = -2.0 * along;
        return *end > 0.0;
    }
    if (square <= 0.0) return false;
    *begin = fmax(-along - sqrt(square), 0.0);
    *end = -along + sqrt(square);
    return *end > 0.0;
}

// Cuts the stretch to what lies between two faces.
static bool cross_faces(double offset, double direction, double half, double touch, double *begin, double *end)
{
    double first, second;

    if (fabs(fabs(offset) - half) <= touch) offset = copysign(half, offset);
    if (direction == 0.0) return fabs(offset) < half;
    first = (-half - offset) / direction;
    second = (half - offset) / direction;
    *begin = fmax(*begin, fmin(first, second));
    *end = fmin(*end, fmax(first, second));
    return *begin < *end;
}

static bool cross_box(const struct shape *box, const struct ray *ray, double touch, double *begin, double *end)
{
    struct vec3 offset = vec3_subtract(ray->origin, box->center);

    *begin = 0.0;
    *end = INFINITY;
    return cross_faces(offset.x, ray->direction.x, box->half.x, touch, begin, end) &&
           cross_faces(offset.y, ray->direction.y, box->half.y, touch, begin, end) &&
           cross_faces(offset.z, ray->direction.z, box->half.z, touch, begin, end);
}

static bool cross_plane(const struct shape *plane, const struct ray *ray, double touch, double *begin, double *end)
{
    double height = vec3_dot(vec3_subtract(ray->origin, plane->center), plane->normal);
    double climb = vec3_dot(ray->direction, plane->normal);

    if (fabs(height) <= touch) height = 0.0;
    *begin = 0.0;
    *end = INFINITY;
    if (height < 0.0) {
        if (climb > 0.0) *end = -height / climb;
        return true;
    }
    if (climb >= 0.0) return false;
    *begin = height / -climb;
    return true;
}

bool shape_cross(const struct shape *shape, const struct ray *ray, double *begin, double *end)
{
    double touch = touch_distance(shape, ray->origin);

    switch (shape->kind) {
    case SCENE_SHAPE_SPHERE:
        return cross_sphere(shape, ray, touch, begin, end);
    case SCENE_SHAPE_BOX:
        return cross_box(shape, ray, touch, begin, end);
    case SCENE_SHAPE_PLANE:
        break;
    }
    return cross_plane(shape, ray, touch, begin, end);
}

static struct vec3 sphere_normal(const struct shape *sphere, struct vec3 position)
{
    static const struct vec3 UP = {0.0, 1.0, 0.0};
    struct vec3 offset = vec3_subtract(position, sphere->center);

    // Every point of the boundary is equally near to the centre.
    return vec3_length(offset) > 0.0 ? vec3_normalize(offset) : UP;
}

// The normal of the nearest face.
static struct vec3 box_normal(const struct shape *box, struct vec3 position)
{
    struct vec3 offset = vec3_subtract(position, box->center);
    double x = fabs(fabs(offset.x) - box->half.x), y = fabs(fabs(offset.y) - box->half.y),
           z = fabs(fabs(offset.z) - box->half.z);

    if (x <= y && x <= z) return (struct vec3){copysign(1.0, offset.x), 0.0, 0.0};
    if (y <= z) return (struct vec3){0.0, copysign(1.0, offset.y), 0.0};
    return (struct vec3){0.0, 0.0, copysign(1.0, offset.z)};
}

struct vec3 shape_normal(const struct shape *shape, struct vec3 position)
{
    switch (shape->kind) {
    case SCENE_SHAPE_SPHERE:
        return sphere_normal(shape, position);
    case SCENE_SHAPE_BOX:
        return box_normal(shape, position);
    case SCENE_SHAPE_PLANE:
        break;
    }
    return shape->normal;
}

static struct vec3 snap_to_box(const struct shape *box, struct vec3 position)
{
    struct vec3 normal = box_normal(box, position);

    if (normal.x != 0.0) position.x = box->center.x + normal.x * box->half.x;
    if (normal.y != 0.0) position.y = box->center.y + normal.y * box->half.y;
    if (normal.z != 0.0) position.z = box->center.z + normal.z * box->half.z;
    return position;
}

struct vec3 shape_snap(const struct shape *shape, struct vec3 position)
{
    double height;

    switch (shape->kind) {
    case SCENE_SHAPE_SPHERE:
        return vec3_add(shape->center, vec3_scale(sphere_normal(shape, position), shape->radius));
    case SCENE_SHAPE_BOX:
        return snap_to_box(shape, position);
    case SCENE_SHAPE_PLANE:
        break;
    }
    height = vec3_dot(vec3_subtract(position, shape->center), shape->normal);
    return vec3_subtract(position, vec3_scale(shape->normal, height));
}
