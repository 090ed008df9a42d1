// Solid objects, their materials, and which of them contain a point of a ray.
// SPDX-License-Identifier: Apache-2.0
// A region is the space of one object, or the air around all objects. Where objects overlap, the space is the later
// one's.
#pragma once

#include "core/scene/scene.h"
#include "reference/fresnel.h"
#include "reference/shape.h"
#include "reference/texture.h"

#include <stdbool.h>
#include <stddef.h>

struct material {
    enum scene_material_kind kind;
    double albedo[3];       // of diffuse; times the texture's where there is one
    double specular;        // of diffuse: F times this is reflected as by a mirror
    double reflectance[3];  // of a mirror
    struct fresnel fresnel; // of dielectric, and of diffuse with a specular share
    double ior;             // of the same
    double roughness;
    struct texture texture; // of diffuse
};

// An object: the union of its shapes.
struct object {
    size_t first_shape, shape_count; // in `shapes`
    struct material material;
};

// The zero value is air alone.
struct objects {
    struct shape shapes[SCENE_SHAPE_LIMIT];
    struct object list[SCENE_OBJECT_LIMIT];
    size_t count;
};

// A piece of a ray within one region. Region 0 is air, i + 1 is object i.
struct object_piece {
    double begin, end; // m along the ray
    size_t region;     // differs from those of the pieces before and after
    size_t shape;      // whose boundary is crossed at `end`: the later object's; not set for the last piece
};

enum { OBJECT_PIECE_LIMIT = 2 * SCENE_SHAPE_LIMIT + 1 };

struct object_walk {
    struct object_piece pieces[OBJECT_PIECE_LIMIT];
    size_t count; // at least 1
};

// The regions along the ray from 0 to `far`, which may be INFINITY. Pieces thinner than rounding errors are left out,
// so that coinciding boundaries are crossed together.
void objects_walk(const struct objects *objects, const struct ray *ray, double far, struct object_walk *walk);
// True when the region is neither air nor dielectric.
bool objects_is_opaque(const struct objects *objects, size_t region);
double objects_ior(const struct objects *objects, size_t region); // of air and dielectrics
