// SPDX-License-Identifier: Apache-2.0
#include "reference/spot_edges.h"

#include <math.h>

// At the distance t the ray is from + t direction, seen from the spot. On the cone its part along the axis is
// cosine times its length: square t^2 + 2 half t + rest = 0.
static void split_at_cone(const struct light *light, const struct ray *ray, double angle, struct span_list *spans)
{
    struct vec3 from = vec3_subtract(ray->origin, light->position);
    double start = vec3_dot(from, light->direction), slope = vec3_dot(ray->direction, light->direction);
    double cosine = cos(angle), along = vec3_dot(from, ray->direction);
    double square = slope * slope - cosine * cosine, half = start * slope - cosine * cosine * along;
    double rest = start * start - cosine * cosine * vec3_dot(from, from), root = half * half - square * rest, sum;

    if (root < 0.0) return;
    // The sum of two numbers of one sign: neither root is a difference.
    sum = half < 0.0 ? half - sqrt(root) : half + sqrt(root);
    if (square != 0.0) span_list_split(spans, -sum / square);
    if (sum != 0.0) span_list_split(spans, -rest / sum);
}

void spot_edges_split(const struct light *light, const struct ray *ray, struct span_list *spans)
{
    if (light->kind != SCENE_LIGHT_SPOT) return;
    split_at_cone(light, ray, light->inner, spans);
    split_at_cone(light, ray, light->outer, spans);
}
