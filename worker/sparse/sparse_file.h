// A file of sparse grids in memory, whatever its format.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "worker/sparse/nanovdb_file.h"

#include <stdbool.h>

struct error;
struct sparse_grid;

// Decodes the grid of this name (NULL: the first of floats). NULL on failure. The caller destroys it.
typedef struct sparse_grid *sparse_file_decoder(const struct nanovdb_bytes *bytes, const char *name,
                                                struct error *error);

// The zero value is empty.
struct sparse_file {
    struct nanovdb_bytes bytes; // owned; converted where the format needs it
    sparse_file_decoder *decode;
};

// Reads the file by its name's ending. `hash` (may be NULL) becomes the hash of the file's own bytes, also where only
// the conversion fails. Messages do not name the path.
bool sparse_file_load(struct sparse_file *file, const char *path, char *hash, struct error *error);
void sparse_file_finish(struct sparse_file *file); // accepts an empty one
struct sparse_grid *sparse_file_decode(const struct sparse_file *file, const char *name, struct error *error);
