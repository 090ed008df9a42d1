// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/texture_input.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/scene/scene.h"
#include "worker/picture/image.h"
#include "worker/scene/texture_image.h"

#include <stdlib.h>
#include <string.h>

// The hash says whether the image is decoded.
static bool hash_contents(struct texture_input *input, struct file_hashes *hashes, struct error *error)
{
    char hash[HASH_TEXT_SIZE];
    char *text;

    if (!file_hashes_find(hashes, input->source->file, &input->version, hash, error)) return false;
    text = xasprintf("%s texture %s", hash,
                     input->source->is_radiance ? "radiance"
                     : input->source->is_linear ? "linear"
                                                : "srgb");
    hash_bytes(text, strlen(text), input->hash);
    free(text);
    return true;
}

// Returns false when the file has changed since it was hashed.
static bool check_version(const struct texture_input *input, struct error *error)
{
    struct file_version version;

    if (!file_version_find(input->source->file, &version, error)) return false;
    if (file_version_is_same(&version, &input->version)) return true;
    error_set(error, "%s: it changed while the frame was made", input->source->file);
    return false;
}

bool texture_input_open(struct texture_input *input, const struct scene_texture *texture, struct file_hashes *hashes,
                        struct error *error)
{
    *input = (struct texture_input){.source = texture};
    if (hashes && !hash_contents(input, hashes, error)) return false;
    if (!texture_image_find_size(texture->file, &input->width_px, &input->height_px, error)) return false;
    return !hashes || check_version(input, error);
}

bool texture_input_load(const struct texture_input *input, struct image *image, struct error *error)
{
    if (!texture_image_load(image, input->source, error)) return false;
    if (check_version(input, error)) return true;
    image_finish(image);
    return false;
}

void texture_input_find_tile(const struct texture_input *input, double size[static 2])
{
    const double *wanted = input->source->size;

    size[0] = wanted[0];
    size[1] = wanted[1] > 0 ? wanted[1] : wanted[0] * input->height_px / input->width_px;
}
