// SPDX-License-Identifier: Apache-2.0
#include "worker/density/density_modules.h"

#include "worker/density/density_bake.h"
#include "worker/density/density_kind.h"
#include "worker/density/scene_bounds.h"
#include "worker/glsl/shader_assembly.h"

#include <stdlib.h>

static void add_text(struct shader_assembly *assembly, const struct density_text *text)
{
    shader_assembly_generate(assembly);
    fputs(text->before, assembly->out);
    shader_assembly_add_text(assembly, text->name, text->text);
    fputs(text->after, assembly->out);
}

void density_modules_add(struct shader_assembly *assembly, const struct density_site *site)
{
    const struct scene_density *density = &site->source->density;
    const struct density_kind *kind = density_kind_of(density);
    struct density_text text = {0};
    struct density_bake bake;
    const char *bounds = scene_bounds_module(&density->bounds);

    for (const char *const *name = kind->modules(site); *name; ++name)
        shader_assembly_add(assembly, *name);
    // A program that reads the grid does not need the code that filled it.
    if (kind->load_text && (site->fills_grid || !density_bake_find(&bake, site->job, site->medium)) &&
        !assembly->has_failed) {
        assembly->has_failed = !kind->load_text(site, &text, assembly->error);
        if (!assembly->has_failed) add_text(assembly, &text);
        free(text.before);
        free(text.after);
    }
    if (bounds) shader_assembly_add(assembly, bounds);
}
