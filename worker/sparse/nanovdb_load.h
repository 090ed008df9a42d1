// Brings the bytes of a sparse grid's file into memory, those of OpenVDB as NanoVDB has them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/sparse/nanovdb_file.h"

#include <stdbool.h>

struct error;

// As they are in the file. `file->bytes` are the caller's to free; NULL on failure.
bool nanovdb_load(struct nanovdb_bytes *file, const char *path, struct error *error);
// The same of an OpenVDB file once it is converted.
bool nanovdb_load_converted(struct nanovdb_bytes *file, const char *path, struct error *error);
