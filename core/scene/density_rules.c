// SPDX-License-Identifier: Apache-2.0
#include "core/scene/density_rules.h"

static const struct density_rules *const rules[] = {
    [SCENE_DENSITY_FOLD_FRACTAL] = &density_rules_fold_fractal,
    [SCENE_DENSITY_HOMOGENEOUS] = &density_rules_homogeneous,
    [SCENE_DENSITY_NOISE] = &density_rules_noise,
    [SCENE_DENSITY_GRID] = &density_rules_grid,
    [SCENE_DENSITY_GLSL] = &density_rules_glsl,
};

enum { COUNT = sizeof rules / sizeof rules[0] };
_Static_assert((int)COUNT < (int)DENSITY_RULES_LIMIT, "a list has room for all names and NULL");

const struct density_rules *density_rules_of(const struct scene_density *density)
{
    return rules[density->kind];
}

void density_rules_list(const char *names[static DENSITY_RULES_LIMIT])
{
    for (int i = 0; i < COUNT; i++)
        names[i] = rules[i]->name;
    names[COUNT] = NULL;
}
