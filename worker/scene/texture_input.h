// File of an object's texture or of a dome: what it holds, and the size of a texture's tiles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "worker/volume/file_hashes.h"

#include <stdbool.h>

struct error;
struct image;
struct scene_texture;

// The zero value is that of an object without a texture, and of a scene without such a dome.
struct texture_input {
    const struct scene_texture *source; // borrowed from the job; NULL: there is none
    int width_px, height_px;
    // Hash of the contents and of how they are read; empty when only described.
    char hash[HASH_TEXT_SIZE];
    struct file_version version;
};

// Reads the header. With `hashes` (NULL: describe only) the contents are hashed too. `texture` outlives the input.
bool texture_input_open(struct texture_input *input, const struct scene_texture *texture, struct file_hashes *hashes,
                        struct error *error);
// Loads the image, as texture_image_load does, if the file is the one that was hashed.
bool texture_input_load(const struct texture_input *input, struct image *image, struct error *error);
// Finds the size of a tile, m, across and up.
void texture_input_find_tile(const struct texture_input *input, double size[static 2]);
