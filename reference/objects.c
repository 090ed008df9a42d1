// SPDX-License-Identifier: Apache-2.0
#include "reference/objects.h"

#include <math.h>

// Tolerance, relative to the distances that take part.
static const double SLIVER = 1e-11;

// A stretch of the ray inside one object, and the shapes where it begins and ends.
struct stay {
    double begin, end;
    size_t first_shape, last_shape;
};

struct stays {
    struct stay list[SCENE_SHAPE_LIMIT];
    size_t count;
};

static void insert_by_begin(struct stays *stays, const struct stay *stay)
{
    size_t at = stays->count++;

    while (at > 0 && stays->list[at - 1].begin > stay->begin) {
        stays->list[at] = stays->list[at - 1];
        at--;
    }
    stays->list[at] = *stay;
}

// Joins stretches that overlap or touch.
static void join(struct stays *stays, double sliver)
{
    size_t kept = 0;

    for (size_t i = 0; i < stays->count; i++) {
        const struct stay *next = &stays->list[i];
        struct stay *last = kept > 0 ? &stays->list[kept - 1] : NULL;

        if (!last || next->begin > last->end + sliver) {
            stays->list[kept++] = *next;
        } else if (next->end > last->end) {
            last->end = next->end;
            last->last_shape = next->last_shape;
        }
    }
    stays->count = kept;
}

static void find_stays(const struct objects *objects, const struct object *object, const struct ray *ray,
                       struct stays *stays)
{
    stays->count = 0;
    for (size_t i = 0; i < object->shape_count; i++) {
        size_t shape = object->first_shape + i;
        struct stay stay = {.first_shape = shape, .last_shape = shape};

        if (shape_cross(&objects->shapes[shape], ray, &stay.begin, &stay.end)) insert_by_begin(stays, &stay);
    }
    if (stays->count > 1) join(stays, SLIVER * (vec3_length(ray->origin) + stays->list[stays->count - 1].begin));
}

// The distances where a stretch begins or ends, ascending.
struct cuts {
    double at[OBJECT_PIECE_LIMIT + 1];
    size_t count;
};

static void insert_cut(struct cuts *cuts, double distance)
{
    size_t at = cuts->count++;

    while (at > 0 && cuts->at[at - 1] > distance) {
        cuts->at[at] = cuts->at[at - 1];
        at--;
    }
    cuts->at[at] = distance;
}

static size_t region_at(const struct stays *stays, size_t object_count, double distance)
{
    for (size_t i = object_count; i > 0; i--) {
        for (size_t k = 0; k < stays[i - 1].count; k++) {
            const struct stay *stay = &stays[i - 1].list[k];

            if (stay->begin < distance && distance < stay->end) return i;
        }
    }
    return 0;
}

// Appends a piece, or lengthens the last one if it has the same region.
static void append(struct object_walk *walk, double begin, double end, size_t region)
{
    struct object_piece *last = walk->count > 0 ? &walk->pieces[walk->count - 1] : NULL;

    if (last && last->region == region) {
        last->end = end;
    } else {
        walk->pieces[walk->count++] = (struct object_piece){last ? last->end : begin, end, region, 0};
    }
}

// The shape that is crossed between two regions: the later object begins there, or ends.
static size_t find_crossed_shape(const struct stays *stays, const struct object_piece *piece, size_t next_region)
{
    bool is_entering = next_region > piece->region;
    const struct stays *own = &stays[(is_entering ? next_region : piece->region) - 1];
    double nearest = INFINITY;
    size_t shape = 0;

    for (size_t k = 0; k < own->count; k++) {
        const struct stay *stay = &own->list[k];
        double distance = fabs((is_entering ? stay->begin : stay->end) - piece->end);

        if (distance >= nearest) continue;
        nearest = distance;
        shape = is_entering ? stay->first_shape : stay->last_shape;
    }
    return shape;
}

void objects_walk(const struct objects *objects, const struct ray *ray, double far, struct object_walk *walk)
{
    struct stays stays[SCENE_OBJECT_LIMIT];
    struct cuts cuts = {.at = {0.0}, .count = 1};

    for (size_t i = 0; i < objects->count; i++) {
        find_stays(objects, &objects->list[i], ray, &stays[i]);
        for (size_t k = 0; k < stays[i].count; k++) {
            if (stays[i].list[k].begin < far) insert_cut(&cuts, stays[i].list[k].begin);
            if (stays[i].list[k].end < far) insert_cut(&cuts, stays[i].list[k].end);
        }
    }
    insert_cut(&cuts, far);
    walk->count = 0;
    for (size_t i = 0; i + 1 < cuts.count; i++) {
        double begin = cuts.at[i], end = cuts.at[i + 1];
        bool is_thin = end - begin <= SLIVER * (vec3_length(ray->origin) + begin);

        // A ray of length 0 has a region too.
        if (is_thin && (i + 2 < cuts.count || walk->count > 0)) continue;
        append(walk, begin, end,
               region_at(stays, objects->count, isinf(end) ? 2.0 * begin + 1.0 : 0.5 * (begin + end)));
    }
    for (size_t i = 0; i + 1 < walk->count; i++)
        walk->pieces[i].shape = find_crossed_shape(stays, &walk->pieces[i], walk->pieces[i + 1].region);
}

bool objects_is_opaque(const struct objects *objects, size_t region)
{
    return region > 0 && objects->list[region - 1].material.kind != SCENE_MATERIAL_DIELECTRIC;
}

double objects_ior(const struct objects *objects, size_t region)
{
    return region > 0 ? objects->list[region - 1].material.ior : 1.0;
}
