// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density.h"

#include "core/scene/input_path.h"

#include <string.h>

bool scene_grid_is_vdb(const struct scene_grid *grid)
{
    return input_path_has_ending(grid->file, ".nvdb") || input_path_has_ending(grid->file, ".vdb");
}

const char *scene_glsl_name(const struct scene_glsl *glsl)
{
    const char *slash = glsl->file ? strrchr(glsl->file, '/') : NULL;

    if (!glsl->file) return "density.source";
    return slash ? slash + 1 : glsl->file;
}
