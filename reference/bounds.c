// SPDX-License-Identifier: Apache-2.0
#include "reference/bounds.h"

#include <math.h>

// A layer: inside, dot(normal, p) is between low and high.
struct layer {
    struct vec3 normal; // of length 1
    double low, high;
};

enum { LAYER_LIMIT = 3, FACE_LIMIT = 2 * LAYER_LIMIT };

static struct layer layer_about(struct vec3 normal, struct vec3 center, double half)
{
    double middle = vec3_dot(normal, center);

    return (struct layer){normal, middle - half, middle + half};
}

// A box is three layers, a slab one.
static int find_layers(const struct bounds *bounds, struct layer layers[static LAYER_LIMIT])
{
    if (bounds->kind == SCENE_BOUNDS_SLAB) {
        layers[0] = layer_about(bounds->normal, bounds->center, bounds->half_thickness);
        return 1;
    }
    layers[0] = layer_about((struct vec3){1.0, 0.0, 0.0}, bounds->center, bounds->half.x);
    layers[1] = layer_about((struct vec3){0.0, 1.0, 0.0}, bounds->center, bounds->half.y);
    layers[2] = layer_about((struct vec3){0.0, 0.0, 1.0}, bounds->center, bounds->half.z);
    return 3;
}

static void clip_to_layer(const struct layer *layer, const struct ray *ray, double *near, double *far)
{
    double height = vec3_dot(layer->normal, ray->origin), slope = vec3_dot(layer->normal, ray->direction);
    double a = (layer->low - height) / slope, b = (layer->high - height) / slope;

    if (slope == 0.0) {
        if (height < layer->low || layer->high < height) *far = *near;
        return;
    }
    *near = fmax(*near, fmin(a, b));
    *far = fmin(*far, fmax(a, b));
}

static void clip_to_sphere(struct vec3 center, double radius, const struct ray *ray, double *near, double *far)
{
    double middle = vec3_dot(vec3_subtract(center, ray->origin), ray->direction);
    struct vec3 offset = vec3_subtract(ray_at(ray, middle), center);
    double half_squared = radius * radius - vec3_dot(offset, offset);

    if (half_squared <= 0.0) {
        *far = *near;
        return;
    }
    *near = fmax(*near, middle - sqrt(half_squared));
    *far = fmin(*far, middle + sqrt(half_squared));
}

bool bounds_clip(const struct bounds *bounds, const struct ray *ray, double *near, double *far)
{
    struct layer layers[LAYER_LIMIT];

    switch (bounds->kind) {
    case SCENE_BOUNDS_NONE:
        break;
    case SCENE_BOUNDS_SPHERE:
        clip_to_sphere(bounds->center, bounds->radius, ray, near, far);
        break;
    case SCENE_BOUNDS_BOX:
    case SCENE_BOUNDS_SLAB:
        for (int i = find_layers(bounds, layers) - 1; i >= 0; i--)
            clip_to_layer(&layers[i], ray, near, far);
        break;
    }
    return *near < *far;
}

double bounds_depth(const struct bounds *bounds, struct vec3 position)
{
    struct layer layers[LAYER_LIMIT];
    double depth = INFINITY;

    if (bounds->kind == SCENE_BOUNDS_NONE) return depth;
    if (bounds->kind == SCENE_BOUNDS_SPHERE) {
        return bounds->radius - vec3_length(vec3_subtract(position, bounds->center));
    }
    for (int i = find_layers(bounds, layers) - 1; i >= 0; i--) {
        double height = vec3_dot(layers[i].normal, position);

        depth = fmin(depth, fmin(height - layers[i].low, layers[i].high - height));
    }
    return depth;
}

static double weight_at_depth(const struct bounds *bounds, double depth)
{
    double share;

    if (depth < 0.0) return 0.0;
    if (depth >= bounds->falloff) return 1.0;
    share = depth / bounds->falloff;
    return share * share * (3.0 - 2.0 * share);
}

double bounds_weight(const struct bounds *bounds, struct vec3 position)
{
    return weight_at_depth(bounds, bounds_depth(bounds, position));
}

double bounds_most(const struct bounds *bounds, const struct box *box)
{
    double radius = box_radius(box);

    // The weight grows with the depth, and the depth by no more than the way.
    return isinf(radius) ? 1.0 : weight_at_depth(bounds, bounds_depth(bounds, box->center) + radius);
}

bool bounds_extent(const struct bounds *bounds, struct box *box)
{
    *box = (struct box){bounds->center, bounds->half};
    if (bounds->kind == SCENE_BOUNDS_SPHERE) box->half = (struct vec3){bounds->radius, bounds->radius, bounds->radius};
    return bounds->kind == SCENE_BOUNDS_SPHERE || bounds->kind == SCENE_BOUNDS_BOX;
}

// Distances to faces are linear along a ray: offset + slope t.
struct face {
    double offset, slope;
};

static void split_at_faces(const struct bounds *bounds, const struct ray *ray, struct span_list *spans)
{
    struct layer layers[LAYER_LIMIT];
    struct face faces[FACE_LIMIT];
    int count = 2 * find_layers(bounds, layers);

    for (int i = 0; i < count; i += 2) {
        double height = vec3_dot(layers[i / 2].normal, ray->origin);
        double slope = vec3_dot(layers[i / 2].normal, ray->direction);

        faces[i] = (struct face){height - layers[i / 2].low, slope};
        faces[i + 1] = (struct face){layers[i / 2].high - height, -slope};
    }
    // A quotient by 0 is not finite and splits nothing.
    for (int i = 0; i < count; i++) {
        span_list_split(spans, (bounds->falloff - faces[i].offset) / faces[i].slope);
        for (int j = 0; j < i; j++) {
            span_list_split(spans, (faces[j].offset - faces[i].offset) / (faces[i].slope - faces[j].slope));
        }
    }
}

static void split_at_sphere(const struct bounds *bounds, const struct ray *ray, struct span_list *spans)
{
    double near = -INFINITY, far = INFINITY;

    // Near the centre the distance to it changes sharply.
    span_list_split(spans, vec3_dot(vec3_subtract(bounds->center, ray->origin), ray->direction));
    if (bounds->radius <= bounds->falloff) return;
    clip_to_sphere(bounds->center, bounds->radius - bounds->falloff, ray, &near, &far);
    span_list_split(spans, near);
    span_list_split(spans, far);
}

void bounds_split(const struct bounds *bounds, const struct ray *ray, struct span_list *spans)
{
    if (bounds->falloff == 0.0 || bounds->kind == SCENE_BOUNDS_NONE) return;
    if (bounds->kind == SCENE_BOUNDS_SPHERE) {
        split_at_sphere(bounds, ray, spans);
    } else {
        split_at_faces(bounds, ray, spans);
    }
}
