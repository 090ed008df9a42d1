// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density.h"

#include "core/scene/file_format.h"

#include <string.h>

bool scene_grid_is_sparse(const struct scene_grid *grid)
{
    return file_format_is(grid->file, FILE_GRID_SPARSE);
}

const char *scene_glsl_name(const struct scene_glsl *glsl)
{
    const char *slash = glsl->file ? strrchr(glsl->file, '/') : NULL;

    if (!glsl->file) return "density.source";
    return slash ? slash + 1 : glsl->file;
}
