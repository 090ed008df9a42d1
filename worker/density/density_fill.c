// SPDX-License-Identifier: Apache-2.0
#include "worker/density/density_fill.h"

#include "worker/density/density_bake.h"
#include "worker/density/density_kind.h"
#include "worker/density/density_modules.h"
#include "worker/glsl/scene_cache.h"
#include "worker/glsl/texture_units.h"

#include <string.h>

// Begins a cache and its text, with one invocation a corner.
static bool begin_cache(struct scene_cache *cache, struct shader_assembly *text, const struct density_site *site,
                        const int corners[static 3], const char *shader_dir, struct error *error)
{
    *cache = (struct scene_cache){.unit = texture_unit_of_baked(site->medium), .format = SCENE_CACHE_R32F};
    memcpy(cache->size, corners, sizeof cache->size);
    memcpy(cache->invocations, corners, sizeof cache->invocations);
    return scene_cache_begin(cache, text, shader_dir, error);
}

// Makes the cache of the field at the corners and at one more beyond them on each side.
static bool make_samples(struct scene_cache *cache, const struct density_site *site, const char *shader_dir,
                         struct error *error)
{
    const struct density_kind *kind = density_kind_of(&site->source->density);
    const struct density_bake bake = density_bake_of(site);
    const int corners[3] = {bake.corners[0] + 2, bake.corners[1] + 2, bake.corners[2] + 2};
    struct shader_assembly text;

    if (!begin_cache(cache, &text, site, corners, shader_dir, error)) return false;
    snprintf(cache->name, sizeof cache->name, "medium_%zu_samples", site->medium);
    cache->is_step = true;
    shader_assembly_add(&text, "math/constants.glsl");
    shader_assembly_add(&text, "region/span.glsl");
    shader_assembly_generate(&text);
    kind->add_baked_values(&cache->uniforms, site);
    density_bake_add_number(&cache->uniforms, site->medium, "cell", bake.cell_m);
    frame_uniforms_declare(&cache->uniforms, text.out);
    density_modules_add(&text, site);
    shader_assembly_generate(&text);
    kind->write_baked(text.out, site);
    fprintf(text.out,
            "void main()\n{\n    frame_uniforms_read();\n"
            "    ivec3 at;\n    if (!cache_find_invocation(at)) return;\n"
            "    vec3 p = vec3(at - 1) * medium_%zu_grid_cell - vec3(%.9e, %.9e, %.9e);\n"
            "    imageStore(cache_image, at, vec4(medium_%zu_baked(p)));\n}\n",
            site->medium, bake.half_size[0], bake.half_size[1], bake.half_size[2], site->medium);
    return scene_cache_end(cache, &text);
}

static bool make_grid(struct scene_cache *cache, const struct density_site *site, const char *shader_dir,
                      struct error *error)
{
    const struct density_bake bake = density_bake_of(site);
    struct shader_assembly text;

    if (!begin_cache(cache, &text, site, bake.corners, shader_dir, error)) return false;
    snprintf(cache->name, sizeof cache->name, "medium_%zu_grid", site->medium);
    shader_assembly_add(&text, "grid/quasi_interpolation.glsl");
    shader_assembly_generate(&text);
    fprintf(text.out,
            "layout(binding = %u) uniform sampler3D samples;\nvoid main()\n{\n"
            "    ivec3 at;\n    if (!cache_find_invocation(at)) return;\n"
            "    imageStore(cache_image, at, vec4(grid_quasi_interpolation(samples, at + 1)));\n}\n",
            cache->unit);
    return scene_cache_end(cache, &text);
}

bool density_fill_add_caches(struct scene_cache *caches, size_t *count, const struct density_site *site,
                             const char *shader_dir, struct error *error)
{
    struct density_site filling = *site;

    filling.fills_grid = true;
    if (!make_samples(&caches[*count], &filling, shader_dir, error)) return false;
    *count += 1;
    if (!make_grid(&caches[*count], &filling, shader_dir, error)) return false;
    caches[*count].reads = (uint64_t)1 << (*count - 1);
    *count += 1;
    return true;
}
