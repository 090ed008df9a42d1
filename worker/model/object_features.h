// What an object of a scene does with light.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <stdbool.h>

struct object_features {
    bool is_opaque;   // else light goes on in it
    bool is_lit;      // diffuse, and not black
    bool reflects;    // it sends a reflected ray
    bool has_fresnel; // which share that is follows from the angle
    bool sends_two;   // a reflected ray and a refracted one at once
    bool is_rough;
    bool is_grey;
};

struct object_features object_features_of(const struct scene_material *material);
// True when a ray that meets it is reflected or refracted.
bool object_features_have_paths(const struct object_features *object);
