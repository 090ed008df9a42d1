// Sparse grids read from files and kept for the frames that show them; the next frame's are read by a thread of their own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "worker/volume/file_hashes.h"

#include <stdbool.h>

struct brick_atlas;
struct brick_store;
struct error;
struct scene_transfer_point;

struct brick_source {
    const char *path;         // .nvdb or .vdb
    const char *density_name; // NULL: the first grid of floats
    const char *glow_name;    // NULL: none
    // Of a transfer function, which decides where the density is empty; none: where no value is above 0.
    const struct scene_transfer_point *points;
    size_t point_count;
};

// Shared; nothing changes it.
struct brick_volume {
    const struct brick_atlas *atlas;
    struct file_version version; // of the file
    char hash[HASH_TEXT_SIZE];   // of the file's bytes
};

struct brick_store *brick_store_create(void);
void brick_store_destroy(struct brick_store *store); // accepts NULL; all volumes are released

// What the file holds now, read here unless it is at hand. NULL on failure.
const struct brick_volume *brick_store_take(struct brick_store *store, const struct brick_source *source,
                                            struct error *error);
void brick_store_release(struct brick_store *store, const struct brick_volume *volume); // accepts NULL

// Has the file read in the background, unless it is at hand or too many wait already. What fails is said by the take.
void brick_store_expect(struct brick_store *store, const struct brick_source *source);

// Reads the file here, for whoever has no store. NULL on failure; released with a NULL store.
const struct brick_volume *brick_volume_load(const struct brick_source *source, struct error *error);
