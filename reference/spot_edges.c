// SPDX-License-Identifier: Apache-2.0
#include "reference/spot_edges.h"

#include <math.h>

// Finds where the ray's line crosses the cone, or its mirror image behind the spot: at most two distances. At the
// distance t the ray is from + t direction, seen from the spot. On the cone its part along the axis is cosine times its
// length: square t^2 + 2 half t + rest = 0.
static int find_crossings(const struct light *light, const struct ray *ray, double angle, double crossings[static 2])
{
    struct vec3 from = vec3_subtract(ray->origin, light->position);
    double start = vec3_dot(from, light->direction), slope = vec3_dot(ray->direction, light->direction);
    double cosine = cos(angle), along = vec3_dot(from, ray->direction);
    double square = slope * slope - cosine * cosine, half = start * slope - cosine * cosine * along;
    double rest = start * start - cosine * cosine * vec3_dot(from, from), root = half * half - square * rest, sum;
    int count = 0;

    if (root < 0.0) return 0;
    // The sum of two numbers of one sign: neither root is a difference.
    sum = half < 0.0 ? half - sqrt(root) : half + sqrt(root);
    if (square != 0.0) crossings[count++] = -sum / square;
    if (sum != 0.0) crossings[count++] = -rest / sum;
    return count;
}

static void split_at_cone(const struct light *light, const struct ray *ray, double angle, struct span_list *spans)
{
    double crossings[2];
    int count = find_crossings(light, ray, angle, crossings);

    for (int i = 0; i < count; i++)
        span_list_split(spans, crossings[i]);
}

void spot_edges_split(const struct light *light, const struct ray *ray, struct span_list *spans)
{
    if (light->kind != SCENE_LIGHT_SPOT) return;
    split_at_cone(light, ray, light->inner, spans);
    split_at_cone(light, ray, light->outer, spans);
}

static bool is_lit(const struct light *spot, const struct ray *ray, double at)
{
    struct vec3 from = vec3_subtract(ray_at(ray, at), spot->position);

    return vec3_dot(from, spot->direction) > cos(spot->outer) * vec3_length(from);
}

bool spot_edges_clip(const struct light *spot, const struct ray *ray, double *near, double *far)
{
    double ends[4] = {*near, *far, *far, *far}, crossings[2];
    int count = find_crossings(spot, ray, spot->outer, crossings), end = 1;

    if (count == 2 && crossings[0] > crossings[1]) {
        double later = crossings[0];

        crossings[0] = crossings[1];
        crossings[1] = later;
    }
    for (int i = 0; i < count; i++)
        if (crossings[i] > *near && crossings[i] < *far) ends[end++] = crossings[i];
    ends[end] = *far;
    for (int i = 0; i < end; i++)
        if (ends[i] < ends[i + 1] && is_lit(spot, ray, 0.5 * (ends[i] + ends[i + 1]))) {
            *near = ends[i];
            *far = ends[i + 1];
            return true;
        }
    return false;
}
