// Texture units of GL by what they hold: shaders declare these bindings, the renderer binds them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <assert.h>
#include <stddef.h>

// Textures of one medium, in the order of its units. The density's kind says which of them there are.
enum medium_texture {
    MEDIUM_TEXTURE_VALUES,    // a dense grid's voxels; the atlas of a sparse grid's bricks
    MEDIUM_TEXTURE_BRICKS,    // how far each brick is from one that is not empty; a sparse grid's index
    MEDIUM_TEXTURE_EXTRA,     // the transfer function's table, the bricks' majorants, or the atlas of what glows
    MEDIUM_TEXTURE_BLACKBODY, // the table of black bodies
    MEDIUM_TEXTURE_COUNT
};

enum {
    TEXTURE_UNIT_MEDIA = 0,         // MEDIUM_TEXTURE_COUNT a medium
    TEXTURE_UNIT_OBJECTS = 32,      // an object's image
    TEXTURE_UNIT_LIGHTS = 48,       // the columns of a light's grid
    TEXTURE_UNIT_BAKED = 64,        // the grid of a density that is baked, one a medium
    TEXTURE_UNIT_DOME = 72,         // the image of a dome
    TEXTURE_UNIT_DOME_TABLE = 73,   // by which directions to it are drawn
    TEXTURE_UNIT_SCATTER = 74,      // the grid of scattered light
    TEXTURE_UNIT_SCATTER_SEEN = 75, // what the picture sees of its nodes
    TEXTURE_UNIT_LIMIT = 76         // GL 4.5 has at least 96
};

static_assert(TEXTURE_UNIT_MEDIA + MEDIUM_TEXTURE_COUNT * SCENE_MEDIUM_LIMIT <= TEXTURE_UNIT_OBJECTS, "media");
static_assert(TEXTURE_UNIT_OBJECTS + SCENE_OBJECT_LIMIT <= TEXTURE_UNIT_LIGHTS, "objects");
static_assert(TEXTURE_UNIT_LIGHTS + SCENE_LIGHT_LIMIT <= TEXTURE_UNIT_BAKED, "lights");
static_assert(TEXTURE_UNIT_BAKED + SCENE_MEDIUM_LIMIT <= TEXTURE_UNIT_DOME, "baked densities");
static_assert(TEXTURE_UNIT_DOME < TEXTURE_UNIT_SCATTER, "a dome");

static inline unsigned texture_unit_of_medium(size_t medium, enum medium_texture texture)
{
    return TEXTURE_UNIT_MEDIA + MEDIUM_TEXTURE_COUNT * (unsigned)medium + texture;
}

static inline unsigned texture_unit_of_object(size_t object)
{
    return TEXTURE_UNIT_OBJECTS + (unsigned)object;
}

static inline unsigned texture_unit_of_light(size_t light)
{
    return TEXTURE_UNIT_LIGHTS + (unsigned)light;
}

static inline unsigned texture_unit_of_baked(size_t medium)
{
    return TEXTURE_UNIT_BAKED + (unsigned)medium;
}
