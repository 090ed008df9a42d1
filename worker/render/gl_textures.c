// SPDX-License-Identifier: Apache-2.0
#include "worker/render/gl_textures.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/gl/gl_functions.h"
#include "worker/picture/image.h"
#include "worker/render/gl_texture.h"
#include "worker/scene/scene_inputs.h"
#include "worker/volume/volume_memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { KEPT_LIMIT = 2 * SCENE_OBJECT_LIMIT };

// Of images that the frame does not need but a next one may: another job's, say.
static const size_t idle_bytes_limit = (size_t)1 << 28;

struct kept_texture {
    char hash[HASH_TEXT_SIZE]; // of the input; empty: none
    unsigned name;             // GL's
    size_t size_bytes;
    uint64_t used; // the frame that last needed it
};

struct gl_textures {
    const struct gl_functions *gl; // borrowed; outlives us
    uint64_t frame_count;
    struct kept_texture kept[KEPT_LIMIT];
};

struct gl_textures *gl_textures_create(const struct gl_functions *gl)
{
    struct gl_textures *textures = xcalloc(1, sizeof *textures);

    textures->gl = gl;
    return textures;
}

static void drop(struct gl_textures *textures, struct kept_texture *kept)
{
    if (kept->name) textures->gl->DeleteTextures(1, &kept->name);
    *kept = (struct kept_texture){0};
}

void gl_textures_clear(struct gl_textures *textures)
{
    for (size_t i = 0; i < KEPT_LIMIT; ++i)
        drop(textures, &textures->kept[i]);
}

void gl_textures_destroy(struct gl_textures *textures)
{
    if (!textures) return;
    gl_textures_clear(textures);
    free(textures);
}

static struct kept_texture *find(struct gl_textures *textures, const char *hash)
{
    for (size_t i = 0; i < KEPT_LIMIT; ++i)
        if (textures->kept[i].hash[0] && strcmp(textures->kept[i].hash, hash) == 0) return &textures->kept[i];
    return NULL;
}

// An empty place, after the images longest unused have gone that are in the way of `size_bytes` more.
static struct kept_texture *make_room(struct gl_textures *textures, size_t size_bytes)
{
    for (;;) {
        struct kept_texture *oldest = NULL, *empty = NULL;
        size_t idle_bytes = size_bytes;

        for (size_t i = 0; i < KEPT_LIMIT; ++i) {
            struct kept_texture *kept = &textures->kept[i];

            if (!kept->hash[0]) {
                empty = kept;
                continue;
            }
            if (kept->used == textures->frame_count) continue;
            idle_bytes += kept->size_bytes;
            if (!oldest || kept->used < oldest->used) oldest = kept;
        }
        // Of twice as many places as a frame has objects one is empty or idle.
        if (!oldest || (empty && idle_bytes <= idle_bytes_limit)) return empty;
        drop(textures, oldest);
    }
}

static size_t size_of(const struct texture_input *input)
{
    return (size_t)input->width_px * (size_t)input->height_px * 4 * sizeof(float);
}

// GL is asked first: what it has no room for need not be read.
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

static struct kept_texture *read_texture(struct gl_textures *textures, const struct texture_input *input,
                                         struct error *error)
{
    struct kept_texture *kept = make_room(textures, size_of(input));
    unsigned name;

    if (!load(textures->gl, input, &name, error)) return NULL;
    *kept = (struct kept_texture){.name = name, .size_bytes = size_of(input), .used = textures->frame_count};
    memcpy(kept->hash, input->hash, sizeof kept->hash);
    log_debug("textures: %s read, %d x %d pixels", input->source->file, input->width_px, input->height_px);
    return kept;
}

struct reading {
    gl_textures_progress *on_progress;
    void *user;
};

static bool bind_object(struct gl_textures *textures, const struct scene_inputs *inputs, size_t object,
                        const struct reading *reading, struct error *error)
{
    const struct texture_input *input = &inputs->textures[object];
    struct kept_texture *kept = find(textures, input->hash);

    if (!kept) {
        kept = read_texture(textures, input, error);
        if (!kept) {
            error_prefix(error, "scene.objects[%zu].material.texture.file", object);
            return false;
        }
        if (reading->on_progress && !reading->on_progress(reading->user)) {
            error_set(error, "stopped while images were read");
            return false;
        }
    }
    kept->used = textures->frame_count;
    textures->gl->BindTextureUnit((GLuint)(GL_TEXTURES_FIRST_UNIT + object), kept->name);
    return true;
}

static bool is_first_of_its_image(const struct scene_inputs *inputs, size_t object)
{
    for (size_t i = 0; i < object; ++i)
        if (inputs->textures[i].source && strcmp(inputs->textures[i].hash, inputs->textures[object].hash) == 0)
            return false;
    return true;
}

// All images of a frame are in GL at once, each only once.
static bool check_memory(const struct scene_inputs *inputs, struct error *error)
{
    int64_t size_bytes = 0;

    for (size_t i = 0; i < SCENE_OBJECT_LIMIT; ++i)
        if (inputs->textures[i].source && is_first_of_its_image(inputs, i))
            size_bytes += (int64_t)size_of(&inputs->textures[i]);
    if (volume_memory_check(size_bytes, volume_memory_limit(), error)) return true;
    error_prefix(error, "scene.objects: the textures");
    return false;
}

bool gl_textures_bind(struct gl_textures *textures, const struct scene_inputs *inputs,
                      gl_textures_progress *on_progress, void *user, struct error *error)
{
    const struct reading reading = {on_progress, user};

    if (!check_memory(inputs, error)) return false;
    textures->frame_count++;
    for (size_t i = 0; i < SCENE_OBJECT_LIMIT; ++i) {
        struct kept_texture *kept = inputs->textures[i].source ? find(textures, inputs->textures[i].hash) : NULL;

        if (kept) kept->used = textures->frame_count;
    }
    for (size_t i = 0; i < SCENE_OBJECT_LIMIT; ++i)
        if (inputs->textures[i].source && !bind_object(textures, inputs, i, &reading, error)) return false;
    return true;
}
