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
#include "worker/textures/dome_table.h"
#include "worker/textures/gl_texture.h"
#include "worker/volume/volume_memory.h"

#include <stdlib.h>
#include <string.h>

enum {
    DOME = SCENE_OBJECT_LIMIT, // its place among the frame's images; before it, by object
    DOME_TABLE,                // made of the dome's image
    IMAGE_LIMIT,
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

static void find_size(const struct texture_input *input, size_t image, int *width_px, int *height_px)
{
    *width_px = input->width_px;
    *height_px = input->height_px;
    if (image == DOME_TABLE) dome_table_size(input->width_px, input->height_px, width_px, height_px);
}

static size_t size_of(const struct texture_input *input, size_t image)
{
    int width, height;

    find_size(input, image, &width, &height);
    return (size_t)width * (size_t)height * 4 * sizeof(float);
}

static bool load_image(const struct texture_input *input, size_t image, struct image *loaded, struct error *error)
{
    struct image of;
    bool ok;

    if (!texture_input_load(input, image == DOME_TABLE ? &of : loaded, error)) return false;
    if (image != DOME_TABLE) return true;
    ok = dome_table_init(loaded, &of, error);
    image_finish(&of);
    return ok;
}

// GL is asked first, for an image that it has no room for need not be read.
static bool load(const struct gl_functions *gl, const struct texture_input *input, size_t image, unsigned *name,
                 struct error *error)
{
    struct image loaded;
    int width, height;

    find_size(input, image, &width, &height);
    if (!gl_texture_create(gl, width, height, name, error)) {
        error_prefix(error, "%s", input->source->file);
        return false;
    }
    if (!load_image(input, image, &loaded, error)) {
        gl->DeleteTextures(1, name);
        return false;
    }
    gl_texture_fill(gl, *name, &loaded);
    image_finish(&loaded);
    return true;
}

// What is kept is known by the hash of its file; a table's has an end of its own.
static void name_key(const struct texture_input *input, size_t image, char key[static HASH_TEXT_SIZE])
{
    char both[2][HASH_TEXT_SIZE] = {{0}, "table"};

    memcpy(key, input->hash, HASH_TEXT_SIZE);
    if (image != DOME_TABLE) return;
    memcpy(both[0], input->hash, sizeof both[0]);
    hash_bytes(both, sizeof both, key);
}

// Returns the index of the texture; -1 on failure.
static int read_texture(struct gl_textures *textures, const struct texture_input *input, size_t image,
                        struct error *error)
{
    int index = lru_make_room(&textures->lru, size_of(input, image), drop, textures);
    char key[HASH_TEXT_SIZE];

    if (!load(textures->gl, input, image, &textures->names[index], error)) return -1;
    name_key(input, image, key);
    lru_put(&textures->lru, index, key, size_of(input, image));
    log_debug("textures: %s read, %d x %d pixels", input->source->file, input->width_px, input->height_px);
    return index;
}

static int find_texture(struct gl_textures *textures, const struct texture_input *input, size_t image)
{
    char key[HASH_TEXT_SIZE];

    name_key(input, image, key);
    return lru_find(&textures->lru, key);
}

struct reading {
    gl_textures_progress *on_progress;
    void *user;
};

// The zero value, with no source, where there is none.
static const struct texture_input *image_of(const struct scene_inputs *inputs, size_t image)
{
    return image >= DOME ? &inputs->dome : &inputs->textures[image];
}

static void name_place(const struct scene_inputs *inputs, size_t image, struct error *error)
{
    if (image < DOME) {
        error_prefix(error, "scene.objects[%zu].material.texture.file", image);
        return;
    }
    for (size_t i = 0; i < inputs->scene->light_count; ++i)
        if (inputs->scene->lights[i].dome.image.file) error_prefix(error, "lights[%zu].file", i);
}

static unsigned unit_of(size_t image)
{
    return image < DOME ? texture_unit_of_object(image) : image == DOME ? TEXTURE_UNIT_DOME : TEXTURE_UNIT_DOME_TABLE;
}

static bool bind_image(struct gl_textures *textures, const struct scene_inputs *inputs, size_t image,
                       const struct reading *reading, struct error *error)
{
    const struct texture_input *input = image_of(inputs, image);
    int index = find_texture(textures, input, image);

    if (index < 0) {
        index = read_texture(textures, input, image, error);
        if (index < 0) {
            name_place(inputs, image, error);
            return false;
        }
        if (reading->on_progress && !reading->on_progress(reading->user)) {
            error_set(error, "stopped while images were read");
            return false;
        }
    }
    textures->gl->BindTextureUnit(unit_of(image), textures->names[index]);
    return true;
}

static bool is_first_of_its_image(const struct scene_inputs *inputs, size_t image)
{
    for (size_t i = 0; i < image && image != DOME_TABLE; ++i)
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
            size_bytes += (int64_t)size_of(image_of(inputs, i), i);
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
        if (image_of(inputs, i)->source) are_there &= find_texture(textures, image_of(inputs, i), i) >= 0;
    // Finding the limit takes as long as drawing a hundred pixels.
    if (!are_there && !check_memory(inputs, error)) return false;
    for (size_t i = 0; i < IMAGE_LIMIT; ++i)
        if (image_of(inputs, i)->source && !bind_image(textures, inputs, i, &reading, error)) return false;
    return true;
}
