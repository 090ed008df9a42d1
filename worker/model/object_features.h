// How an object of a scene interacts with light.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <stdbool.h>

struct object_features {
    bool is_opaque;   // else light enters it
    bool is_lit;      // diffuse, and not black
    bool reflects;    // rays are reflected
    bool has_fresnel; // the reflected share follows from the angle
    bool sends_two;   // both a reflected and a refracted ray at once
    bool is_rough;
    bool is_grey;
};

struct object_features object_features_of(const struct scene_material *material);
// True when a ray that hits the object is reflected or refracted.
bool object_features_have_paths(const struct object_features *object);
