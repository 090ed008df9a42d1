// SPDX-License-Identifier: Apache-2.0
#include "worker/sparse/sparse_file.h"

#include "core/base/error.h"
#include "core/scene/input_path.h"
#include "worker/sparse/nanovdb_load.h"
#include "worker/sparse/volume_nanovdb.h"

#include <stdlib.h>

// Each format with FILE_GRID_SPARSE in core/scene/file_format.c is a row: how its bytes are loaded and decoded.
static const struct format {
    const char *ending;
    bool (*load)(struct nanovdb_bytes *bytes, const char *path, struct error *error);
    sparse_file_decoder *decode;
} formats[] = {
    {".nvdb", nanovdb_load, volume_nanovdb_decode},
    {".vdb", nanovdb_load_converted, volume_nanovdb_decode},
};

enum { FORMAT_COUNT = sizeof formats / sizeof formats[0] };

static const struct format *find_format(const char *path)
{
    for (size_t i = 0; i < FORMAT_COUNT; i++)
        if (input_path_has_ending(path, formats[i].ending)) return &formats[i];
    return NULL;
}

static bool hash_file_bytes(struct sparse_file *file, const char *path, char *hash, struct error *error)
{
    if (!nanovdb_load(&file->bytes, path, error)) return false;
    hash_bytes(file->bytes.bytes, file->bytes.size_bytes, hash);
    return true;
}

bool sparse_file_load(struct sparse_file *file, const char *path, char *hash, struct error *error)
{
    const struct format *format = find_format(path);

    *file = (struct sparse_file){0};
    if (!format) {
        error_set(error, "no format of sparse grids has this ending");
        return false;
    }
    if (hash && !hash_file_bytes(file, path, hash, error)) return false;
    if (!hash || format->load != nanovdb_load) {
        sparse_file_finish(file);
        if (!format->load(&file->bytes, path, error)) return false;
    }
    file->decode = format->decode;
    return true;
}

void sparse_file_finish(struct sparse_file *file)
{
    free((void *)file->bytes.bytes);
    *file = (struct sparse_file){0};
}

struct sparse_grid *sparse_file_decode(const struct sparse_file *file, const char *name, struct error *error)
{
    return file->decode(&file->bytes, name, error);
}
