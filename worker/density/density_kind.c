// SPDX-License-Identifier: Apache-2.0
#include "worker/density/density_kind.h"

static const struct density_kind *const kinds[] = {
    [SCENE_DENSITY_FOLD_FRACTAL] = &density_kind_fold_fractal,
    [SCENE_DENSITY_HOMOGENEOUS] = &density_kind_homogeneous,
    [SCENE_DENSITY_NOISE] = &density_kind_noise,
    [SCENE_DENSITY_GRID] = &density_kind_grid,
    [SCENE_DENSITY_GLSL] = &density_kind_glsl,
};

const struct density_kind *density_kind_of(const struct scene_density *density)
{
    // The grids of these files are sparse.
    if (density->kind == SCENE_DENSITY_GRID && scene_grid_is_sparse(&density->grid)) return &density_kind_bricks;
    return kinds[density->kind];
}
