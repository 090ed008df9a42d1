// SPDX-License-Identifier: Apache-2.0
#include "worker/textures/gl_textures.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/gl/gl_functions.h"
#include "worker/gl/lru.h"
#include "worker/glsl/texture_units.h"
#include "worker/picture/image.h"
#include "worker/scene/scene_inputs.h"
#include "worker/textures/gl_texture.h"
#include "worker/volume/volume_memory.h"

#include <stdlib.h>
#include <string.h>

enum {
    DOME = SCENE_OBJECT_LIMIT, // its place among the frame's images; before it, by object
    IMAGE_LIMIT = SCENE_OBJECT_LIMIT + 1,
    KEPT_LIMIT = 2 * IMAGE_LIMIT // twice what a frame has, so one is empty or idle
};

// Limits the images that the frame does not need but a later one may: another job's, say.
static const size_t idle_bytes_limit = (size_t)1 << 28;

struct gl_textures {
    const struct gl_functions *gl; // borrowed; outlives us
    struct lru lru;                // keyed by the input's hash; a moment is a frame
    unsigned names[KEPT_LIMIT];    // GL's
};

struct gl_textures *gl_textures_create(const struct gl_functions *gl)
{
    struct gl_textures *textures = xcalloc(1, sizeof *textures);

    textures->gl = gl;
    textures->lru = (struct lru){.capacity = KEPT_LIMIT, .idle_bytes_limit = idle_bytes_limit};
    return textures;
}

static void drop(void *user, int index)
{
    struct gl_textures *textures = user;

    textures->gl->DeleteTextures(1, &textures->names[index]);
}

void gl_textures_clear(struct gl_textures *textures)
{
    lru_clear(&textures->lru, drop, textures);
}

void gl_textures_destroy(struct gl_textures *textures)
{
    if (!textures) return;
    gl_textures_clear(textures);
    free(textures);
}

static size_t size_of(const struct texture_input *input)
{
    return (size_t)input->width_px * (size_t)input->height_px * 4 * sizeof(float);
}

// GL is asked first, for an image that it has no room for need not be read.
static bool load(const struct gl_functions *gl, const struct texture_input *input, unsigned *name, struct error *error)
{
    struct image image;

    if (!gl_texture_create(gl, input->width_px, input->height_px, name, error)) {
        error_prefix(error, "%s", input->source->file);
        return false;
    }
    if (!texture_input_load(input, &image, error)) {
        gl->DeleteTextures(1, name);
        return false;
    }
    gl_texture_fill(gl, *name, &image);
    image_finish(&image);
    return true;
}

// Returns the index of the texture; -1 on failure.
static int read_texture(struct gl_textures *textures, const struct texture_input *input, struct error *error)
{
    int index = lru_make_room(&textures->lru, size_of(input), drop, textures);

    if (!load(textures->gl, input, &textures->names[index], error)) return -1;
    lru_put(&textures->lru, index, input->hash, size_of(input));
    log_debug("textures: %s read, %d x %d pixels", input->source->file, input->width_px, input->height_px);
    return index;
}

struct reading {
    gl_textures_progress *on_progress;
    void *user;
};

// The zero value, with no source, where there is none.
static const struct texture_input *image_of(const struct scene_inputs *inputs, size_t image)
{
    return image == DOME ? &inputs->dome : &inputs->textures[image];
}

static void name_place(const struct scene_inputs *inputs, size_t image, struct error *error)
{
    if (image != DOME) {
        error_prefix(error, "scene.objects[%zu].material.texture.file", image);
        return;
    }
    for (size_t i = 0; i < inputs->scene->light_count; ++i)
        if (inputs->scene->lights[i].dome.image.file) error_prefix(error, "lights[%zu].file", i);
}

static bool bind_image(struct gl_textures *textures, const struct scene_inputs *inputs, size_t image,
                       const struct reading *reading, struct error *error)
{
    const struct texture_input *input = image_of(inputs, image);
    int index = lru_find(&textures->lru, input->hash);

    if (index < 0) {
        index = read_texture(textures, input, error);
        if (index < 0) {
            name_place(inputs, image, error);
            return false;
        }
        if (reading->on_progress && !reading->on_progress(reading->user)) {
            error_set(error, "stopped while images were read");
            return false;
        }
    }
    textures->gl->BindTextureUnit(image == DOME ? TEXTURE_UNIT_DOME : texture_unit_of_object(image),
                                  textures->names[index]);
    return true;
}

static bool is_first_of_its_image(const struct scene_inputs *inputs, size_t image)
{
    for (size_t i = 0; i < image; ++i)
        if (image_of(inputs, i)->source && strcmp(image_of(inputs, i)->hash, image_of(inputs, image)->hash) == 0)
            return false;
    return true;
}

// All images of a frame are in GL at once; objects with the same image share it.
static bool check_memory(const struct scene_inputs *inputs, struct error *error)
{
    int64_t size_bytes = 0;

    for (size_t i = 0; i < IMAGE_LIMIT; ++i)
        if (image_of(inputs, i)->source && is_first_of_its_image(inputs, i))
            size_bytes += (int64_t)size_of(image_of(inputs, i));
    if (volume_memory_check(size_bytes, volume_memory_limit(), error)) return true;
    error_prefix(error, "%s", inputs->dome.source ? "the images of the scene" : "scene.objects: the textures");
    return false;
}

bool gl_textures_bind(struct gl_textures *textures, const struct scene_inputs *inputs,
                      gl_textures_progress *on_progress, void *user, struct error *error)
{
    const struct reading reading = {on_progress, user};
    bool are_there = true;

    lru_begin(&textures->lru);
    for (size_t i = 0; i < IMAGE_LIMIT; ++i)
        if (image_of(inputs, i)->source) are_there &= lru_find(&textures->lru, image_of(inputs, i)->hash) >= 0;
    // Finding the limit takes as long as drawing a hundred pixels.
    if (!are_there && !check_memory(inputs, error)) return false;
    for (size_t i = 0; i < IMAGE_LIMIT; ++i)
        if (image_of(inputs, i)->source && !bind_image(textures, inputs, i, &reading, error)) return false;
    return true;
}
