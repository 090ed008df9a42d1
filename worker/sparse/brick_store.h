// Reads sparse grids from files and keeps them for the frames that show them. A thread reads the next frame's ahead.
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
    // The transfer function that says where the density is empty; without points it is empty where no value is above 0.
    const struct scene_transfer_point *points;
    size_t point_count;
};

// Shared and never changed.
struct brick_volume {
    const struct brick_atlas *atlas;
    struct file_version version; // of the file
    char hash[HASH_TEXT_SIZE];   // of the file's bytes
};

struct brick_store *brick_store_create(void);
void brick_store_destroy(struct brick_store *store); // accepts NULL; all volumes are released

// Returns what the file holds now, and reads it unless it is kept. NULL on failure.
const struct brick_volume *brick_store_take(struct brick_store *store, const struct brick_source *source,
                                            struct error *error);
void brick_store_release(struct brick_store *store, const struct brick_volume *volume); // accepts NULL

// Begins to read the file in the background, unless it is kept or too many files are waiting. brick_store_take reports
// errors.
void brick_store_expect(struct brick_store *store, const struct brick_source *source);

// Reads the file without a store. NULL on failure. Release it with a NULL store.
const struct brick_volume *brick_volume_load(const struct brick_source *source, struct error *error);
