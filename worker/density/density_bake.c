// SPDX-License-Identifier: Apache-2.0
#include "worker/density/density_bake.h"

#include "core/job/job.h"
#include "worker/density/density_kind.h"
#include "worker/glsl/scene_cache.h"
#include "worker/glsl/shader_assembly.h"

#include <assert.h>
#include <math.h>
#include <string.h>

bool density_bake_find_bounds(double half_size[static 3], const struct density_site *site)
{
    const struct scene_bounds *bounds = &site->source->density.bounds;
    struct timeline_span span = job_time_span(site->job);
    double least[3], most[3];

    switch (bounds->kind) {
    case SCENE_BOUNDS_SPHERE:
        timeline_find_bounds(&bounds->radius, span, least, most);
        half_size[0] = half_size[1] = half_size[2] = most[0];
        return true;
    case SCENE_BOUNDS_BOX:
        timeline_find_bounds(&bounds->size, span, least, most);
        for (int axis = 0; axis < 3; ++axis)
            half_size[axis] = 0.5 * most[bounds->size.component_count == 3 ? axis : 0];
        return true;
    case SCENE_BOUNDS_NONE:
    case SCENE_BOUNDS_SLAB:
        break;
    }
    return false;
}

bool density_bake_find(struct density_bake *bake, const struct job *job, size_t medium)
{
    const struct scene_medium *source = &job->scene.media[medium];
    const struct density_kind *kind = density_kind_of(&source->density);
    const struct density_site site = {.job = job, .medium = medium, .source = source};
    double longest;

    *bake = (struct density_bake){0};
    if (job->quality.method != JOB_METHOD_CACHED || job->quality.density_grid == 0) return false;
    if (!kind || !kind->find_box || !kind->find_box(&site, bake->half_size)) return false;
    longest = fmax(fmax(bake->half_size[0], bake->half_size[1]), bake->half_size[2]);
    bake->cell_m = 2 * longest / job->quality.density_grid;
    // A side of which only rounding makes one cell more has none more.
    for (int axis = 0; axis < 3; ++axis)
        bake->corners[axis] = (int)ceil(2 * bake->half_size[axis] / bake->cell_m - 1e-6) + 1;
    return !kind->pays_baked || kind->pays_baked(&site, bake);
}

static struct density_bake bake_of(const struct density_site *site)
{
    struct density_bake bake;
    bool is_baked = density_bake_find(&bake, site->job, site->medium);

    assert(is_baked);
    (void)is_baked;
    return bake;
}

static unsigned unit_of(const struct density_site *site)
{
    return SCENE_CACHE_FIRST_UNIT + SCENE_LIGHT_LIMIT + (unsigned)site->medium;
}

static void write_vector(FILE *out, const char *name, const double vector[static 3], size_t medium)
{
    fprintf(out, "const vec3 medium_%zu_%s = vec3(%.9e, %.9e, %.9e);\n", medium, name, vector[0], vector[1], vector[2]);
}

void density_bake_write_look(FILE *out, const struct density_site *site)
{
    const struct density_bake bake = bake_of(site);
    double scale[3], first[3];
    size_t i = site->medium;

    for (int axis = 0; axis < 3; ++axis) {
        scale[axis] = 1 / (bake.cell_m * bake.corners[axis]);
        first[axis] = bake.half_size[axis] * scale[axis] + 0.5 / bake.corners[axis];
    }
    fprintf(out, "layout(binding = %u) uniform sampler3D medium_%zu_grid;\n", unit_of(site), i);
    write_vector(out, "grid_scale", scale, i);
    write_vector(out, "grid_first", first, i);
    fprintf(out,
            "float medium_%zu_baked(vec3 p)\n{\n"
            "    return textureLod(medium_%zu_grid, p * medium_%zu_grid_scale + medium_%zu_grid_first, 0.0).r;\n}\n",
            i, i, i, i);
}

// Begins a cache and its text; what there is to write to it `corners` says.
static bool begin_cache(struct scene_cache *cache, struct shader_assembly *text, const struct density_site *site,
                        const int corners[static 3], const char *shader_dir, struct error *error)
{
    *cache = (struct scene_cache){.unit = unit_of(site), .format = SCENE_CACHE_R32F};
    memcpy(cache->size, corners, sizeof cache->size);
    memcpy(cache->invocations, corners, sizeof cache->invocations);
    if (!shader_assembly_begin(text, shader_dir, error)) return false;
    scene_cache_begin(cache, text->out);
    return true;
}

static bool end_cache(struct scene_cache *cache, struct shader_assembly *text)
{
    memcpy(cache->module_names, text->module_names, sizeof cache->module_names);
    cache->module_count = text->module_count;
    cache->text = shader_assembly_end(text);
    if (cache->text)
        hash_bytes(cache->text, strlen(cache->text), cache->hash);
    else
        scene_cache_finish(cache);
    return cache->text != NULL;
}

// The field at the corners and one beyond them on each side.
static bool make_samples(struct scene_cache *cache, const struct density_site *site, const char *shader_dir,
                         struct error *error)
{
    const struct density_kind *kind = density_kind_of(&site->source->density);
    const struct density_bake bake = bake_of(site);
    const int corners[3] = {bake.corners[0] + 2, bake.corners[1] + 2, bake.corners[2] + 2};
    struct shader_assembly text;

    if (!begin_cache(cache, &text, site, corners, shader_dir, error)) return false;
    snprintf(cache->name, sizeof cache->name, "medium_%zu_samples", site->medium);
    cache->is_step = true;
    shader_assembly_add(&text, "math/constants.glsl");
    shader_assembly_add(&text, "region/span.glsl");
    shader_assembly_generate(&text);
    kind->add_baked_values(&cache->uniforms, site);
    frame_uniforms_declare(&cache->uniforms, text.out);
    shader_assembly_add_density(&text, site);
    shader_assembly_generate(&text);
    kind->write_baked(text.out, site);
    fputs("void main()\n{\n", text.out);
    if (cache->uniforms.size_bytes > 0) fputs("    frame_uniforms_read();\n", text.out);
    fprintf(text.out,
            "    ivec3 at;\n    if (!cache_find_invocation(at)) return;\n"
            "    vec3 p = vec3(at - 1) * %.9e - vec3(%.9e, %.9e, %.9e);\n"
            "    imageStore(cache_image, at, vec4(medium_%zu_baked(p)));\n}\n",
            bake.cell_m, bake.half_size[0], bake.half_size[1], bake.half_size[2], site->medium);
    return end_cache(cache, &text);
}

static bool make_grid(struct scene_cache *cache, const struct density_site *site, const char *shader_dir,
                      struct error *error)
{
    const struct density_bake bake = bake_of(site);
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
    return end_cache(cache, &text);
}

bool density_bake_add_caches(struct scene_cache *caches, size_t *count, const struct density_site *site,
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
