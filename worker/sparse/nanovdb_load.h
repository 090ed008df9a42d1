// Reads a NanoVDB file into memory, or converts an OpenVDB file and reads the result.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/sparse/nanovdb_file.h"

#include <stdbool.h>

struct error;

// Reads a file's bytes. The caller frees `file->bytes`, which is NULL on failure.
bool nanovdb_load(struct nanovdb_bytes *file, const char *path, struct error *error);
// Converts an OpenVDB file and reads the NanoVDB bytes, as nanovdb_load does.
bool nanovdb_load_converted(struct nanovdb_bytes *file, const char *path, struct error *error);
