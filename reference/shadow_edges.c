// SPDX-License-Identifier: Apache-2.0
#include "reference/shadow_edges.h"

#include "core/scene/light_rules.h"

#include <math.h>
#include <stdbool.h>

// Two ends nearer than this, relative to their distance, count as one.
static const double SLIVER = 1e-9;

// A point of the plane that contains the ray and its shadow rays to one light. In it shapes are discs, polygons and
// half-planes.
struct point {
    double x, y; // m along the ray, and towards the light from it
};

struct disc {
    struct point center;
    double radius;
};

// A part of a line, start + t direction.
struct edge {
    struct point start, direction; // direction of length 1
    double begin, end;             // of t; may be infinite
};

enum { DISC_LIMIT = SCENE_SHAPE_LIMIT, EDGE_LIMIT = 6 * SCENE_SHAPE_LIMIT };

struct section {
    struct ray ray;
    struct vec3 upwards, normal; // of the plane; of length 1, at right angles to the ray
    bool is_parallel;
    struct point light; // or the direction to it
    struct disc discs[DISC_LIMIT];
    size_t disc_count;
    struct edge edges[EDGE_LIMIT];
    size_t edge_count;
};

// False when the light lies on the ray's line: then the plane is not unique.
static bool init_section(struct section *section, const struct light *light, const struct ray *ray)
{
    bool is_parallel = !light_rules_of(light->kind)->has_position;
    struct vec3 to_light =
        is_parallel ? vec3_scale(light->direction, -1.0) : vec3_subtract(light->position, ray->origin);
    double along = vec3_dot(to_light, ray->direction);
    struct vec3 across = vec3_subtract(to_light, vec3_scale(ray->direction, along));
    double height = vec3_length(across);

    if (!(height > 1e-12 * vec3_length(to_light))) return false;
    section->ray = *ray;
    section->upwards = vec3_scale(across, 1.0 / height);
    section->normal = vec3_cross(ray->direction, section->upwards);
    section->is_parallel = is_parallel;
    section->light = (struct point){along, height};
    section->disc_count = section->edge_count = 0;
    return true;
}

static void cut_sphere(struct section *section, const struct shape *sphere)
{
    struct vec3 offset = vec3_subtract(sphere->center, section->ray.origin);
    double height = vec3_dot(offset, section->normal);
    double square = sphere->radius * sphere->radius - height * height;

    if (square <= 0.0) return;
    section->discs[section->disc_count++] =
        (struct disc){{vec3_dot(offset, section->ray.direction), vec3_dot(offset, section->upwards)}, sqrt(square)};
}

// The line in which the section cuts the plane through `position` with that normal; false when it does not cut it.
static bool cut_plane(const struct section *section, struct vec3 position, struct vec3 normal, struct edge *edge)
{
    double x = vec3_dot(normal, section->ray.direction), y = vec3_dot(normal, section->upwards);
    double square = x * x + y * y, length = sqrt(square);
    double offset = vec3_dot(vec3_subtract(position, section->ray.origin), normal);

    if (!(square > 1e-24)) return false;
    *edge = (struct edge){{x * offset / square, y * offset / square}, {-y / length, x / length}, -INFINITY, INFINITY};
    return true;
}

static struct vec3 in_space(const struct section *section, struct point point)
{
    return vec3_add(vec3_scale(section->ray.direction, point.x), vec3_scale(section->upwards, point.y));
}

static void cut_edge_to(struct edge *edge, double offset, double direction, double half)
{
    double first = (-half - offset) / direction, second = (half - offset) / direction;

    if (direction == 0.0) {
        if (fabs(offset) > half) edge->end = -INFINITY;
        return;
    }
    edge->begin = fmax(edge->begin, fmin(first, second));
    edge->end = fmin(edge->end, fmax(first, second));
}

static void cut_box(struct section *section, const struct shape *box)
{
    static const struct vec3 NORMALS[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

    for (int i = 0; i < 6; i++) {
        struct vec3 n = NORMALS[i];
        struct vec3 middle = {n.x * box->half.x, n.y * box->half.y, n.z * box->half.z}, start, direction;
        struct edge edge;

        if (!cut_plane(section, vec3_add(box->center, middle), n, &edge)) continue;
        start = vec3_subtract(vec3_add(section->ray.origin, in_space(section, edge.start)), box->center);
        direction = in_space(section, edge.direction);
        if (n.x == 0.0) cut_edge_to(&edge, start.x, direction.x, box->half.x);
        if (n.y == 0.0) cut_edge_to(&edge, start.y, direction.y, box->half.y);
        if (n.z == 0.0) cut_edge_to(&edge, start.z, direction.z, box->half.z);
        if (edge.begin < edge.end) section->edges[section->edge_count++] = edge;
    }
}

static void cut_shape(struct section *section, const struct shape *shape)
{
    struct edge edge;

    switch (shape->kind) {
    case SCENE_SHAPE_SPHERE:
        cut_sphere(section, shape);
        break;
    case SCENE_SHAPE_BOX:
        cut_box(section, shape);
        break;
    case SCENE_SHAPE_PLANE:
        if (cut_plane(section, shape->center, shape->normal, &edge)) section->edges[section->edge_count++] = edge;
        break;
    }
}

// Splits where the shadow ray passes `point`, unless an end is there already.
static void split_at(const struct section *section, struct point point, struct span_list *spans)
{
    double x = section->light.x, y = section->light.y, distance;

    if (!(point.y > 0.0) || (!section->is_parallel && point.y >= y)) return;
    distance = section->is_parallel ? point.x - point.y * x / y : x + (point.x - x) * y / (y - point.y);
    for (size_t i = 0; i < spans->count; i++) {
        double sliver = SLIVER * fabs(distance);

        if (distance > spans->spans[i].begin + sliver && distance < spans->spans[i].end - sliver) {
            span_list_split(spans, distance);
            return;
        }
    }
}

static void split_at_tangents(const struct section *section, const struct disc *disc, struct span_list *spans)
{
    double x = section->light.x, y = section->light.y, radius = disc->radius, along, across, distance;

    if (!section->is_parallel) {
        x -= disc->center.x;
        y -= disc->center.y;
    }
    distance = hypot(x, y);
    if (!section->is_parallel && distance <= radius) return;
    // From the centre: towards the light, and at right angles to that.
    along = section->is_parallel ? 0.0 : radius * radius / distance;
    across = sqrt(radius * radius - along * along);
    for (int side = -1; side <= 1; side += 2) {
        split_at(section,
                 (struct point){disc->center.x + (along * x - side * across * y) / distance,
                                disc->center.y + (along * y + side * across * x) / distance},
                 spans);
    }
}

static struct point point_of(const struct edge *edge, double t)
{
    return (struct point){edge->start.x + t * edge->direction.x, edge->start.y + t * edge->direction.y};
}

static void split_at_crossing(const struct section *section, const struct edge *a, const struct edge *b,
                              struct span_list *spans)
{
    double sine = a->direction.x * b->direction.y - a->direction.y * b->direction.x;
    double x = b->start.x - a->start.x, y = b->start.y - a->start.y;
    double on_a = (x * b->direction.y - y * b->direction.x) / sine;
    double on_b = (x * a->direction.y - y * a->direction.x) / sine;

    // Not "on_a < begin": NaN, from parallel edges, must not pass.
    if (on_a >= a->begin && on_a <= a->end && on_b >= b->begin && on_b <= b->end)
        split_at(section, point_of(a, on_a), spans);
}

static void split_at_chord(const struct section *section, const struct edge *edge, const struct disc *disc,
                           struct span_list *spans)
{
    double x = disc->center.x - edge->start.x, y = disc->center.y - edge->start.y;
    double middle = x * edge->direction.x + y * edge->direction.y;
    double height = x * edge->direction.y - y * edge->direction.x;
    double square = disc->radius * disc->radius - height * height;

    if (square <= 0.0) return;
    for (int side = -1; side <= 1; side += 2) {
        double t = middle + side * sqrt(square);

        if (t >= edge->begin && t <= edge->end) split_at(section, point_of(edge, t), spans);
    }
}

static void split_at_lens(const struct section *section, const struct disc *a, const struct disc *b,
                          struct span_list *spans)
{
    double x = b->center.x - a->center.x, y = b->center.y - a->center.y, distance = hypot(x, y);
    double along = 0.5 * (distance + (a->radius * a->radius - b->radius * b->radius) / distance);
    double square = a->radius * a->radius - along * along;

    if (!(square > 0.0)) return;
    for (int side = -1; side <= 1; side += 2) {
        split_at(section,
                 (struct point){a->center.x + (along * x - side * sqrt(square) * y) / distance,
                                a->center.y + (along * y + side * sqrt(square) * x) / distance},
                 spans);
    }
}

static void split_at_edges(const struct section *section, struct span_list *spans)
{
    for (size_t i = 0; i < section->edge_count; i++) {
        const struct edge *edge = &section->edges[i];

        if (isfinite(edge->begin)) split_at(section, point_of(edge, edge->begin), spans);
        if (isfinite(edge->end)) split_at(section, point_of(edge, edge->end), spans);
        for (size_t k = 0; k < i; k++)
            split_at_crossing(section, edge, &section->edges[k], spans);
        for (size_t k = 0; k < section->disc_count; k++)
            split_at_chord(section, edge, &section->discs[k], spans);
    }
}

void shadow_edges_split(const struct objects *objects, const struct light *light, const struct ray *ray,
                        struct span_list *spans)
{
    struct section section;

    if (objects->count == 0 || spans->count == 0 || !init_section(&section, light, ray)) return;
    for (size_t i = 0; i < objects->count; i++) {
        const struct object *object = &objects->list[i];

        for (size_t k = 0; k < object->shape_count; k++)
            cut_shape(&section, &objects->shapes[object->first_shape + k]);
    }
    split_at_edges(&section, spans);
    for (size_t i = 0; i < section.disc_count; i++) {
        split_at_tangents(&section, &section.discs[i], spans);
        for (size_t k = 0; k < i; k++)
            split_at_lens(&section, &section.discs[i], &section.discs[k], spans);
    }
}
