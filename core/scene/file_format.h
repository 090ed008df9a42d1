// File formats that a scene may read, by the ending of the name. A new one is a row here and a reader in the worker.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

// Bits, so that lists can be of several.
enum file_content {
    FILE_GRID_RAW = 1,    // voxels alone: the job says their size and type
    FILE_GRID_DENSE = 2,  // a header and all voxels of a box
    FILE_GRID_SPARSE = 4, // named grids, each a tree
    FILE_IMAGE = 8
};

struct file_format {
    const char *ending; // with its dot
    enum file_content content;
    bool is_linear;       // an image's values are linear light unless the job says otherwise; else sRGB
    bool needs_converter; // the worker runs a program of OpenVDB's to read it
};

extern const struct file_format file_formats[];
extern const size_t file_format_count;

// NULL when no format has the ending of this path.
const struct file_format *file_format_find(const char *path);
// True when the path's format is one of these contents.
bool file_format_is(const char *path, unsigned contents);
// The endings of these contents, as in ".nvdb and .vdb" for the word "and". Owned by the caller.
char *file_format_list_endings(unsigned contents, const char *word);
