// SPDX-License-Identifier: Apache-2.0
#include "worker/density/density_bake.h"

#include "core/job/job.h"
#include "worker/density/density_kind.h"
#include "worker/glsl/frame_uniforms.h"
#include "worker/glsl/texture_units.h"
#include "worker/glsl/timeline_value.h"

#include <assert.h>
#include <math.h>

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
    // Rounding alone adds no cell to a side.
    for (int axis = 0; axis < 3; ++axis)
        bake->corners[axis] = (int)ceil(2 * bake->half_size[axis] / bake->cell_m - 1e-6) + 1;
    return !kind->pays_baked || kind->pays_baked(&site, bake);
}

struct density_bake density_bake_of(const struct density_site *site)
{
    struct density_bake bake;
    bool is_baked = density_bake_find(&bake, site->job, site->medium);

    assert(is_baked);
    (void)is_baked;
    return bake;
}

static void add(struct frame_uniforms *uniforms, size_t medium, const char *name, enum frame_value_type type,
                const double numbers[static 3])
{
    frame_uniforms_add(uniforms,
                       (struct frame_value){.type = type,
                                            .origin = FRAME_VALUE_GIVEN,
                                            .given = {numbers[0], numbers[1], numbers[2]},
                                            .min = value_range_not_negative.min,
                                            .max = value_range_not_negative.max,
                                            .meaning = "quality.density_grid"},
                       "medium_%zu_grid_%s", medium, name);
}

void density_bake_add_number(struct frame_uniforms *uniforms, size_t medium, const char *name, double number)
{
    add(uniforms, medium, name, FRAME_VALUE_FLOAT, (const double[3]){number});
}

void density_bake_add_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    const struct density_bake bake = density_bake_of(site);
    double scale[3], first[3];

    for (int axis = 0; axis < 3; ++axis) {
        scale[axis] = 1 / (bake.cell_m * bake.corners[axis]);
        first[axis] = bake.half_size[axis] * scale[axis] + 0.5 / bake.corners[axis];
    }
    add(uniforms, site->medium, "scale", FRAME_VALUE_VEC3, scale);
    add(uniforms, site->medium, "first", FRAME_VALUE_VEC3, first);
}

void density_bake_write_lookup(FILE *out, const struct density_site *site)
{
    size_t i = site->medium;

    fprintf(out,
            "layout(binding = %u) uniform sampler3D medium_%zu_grid;\n"
            "float medium_%zu_baked(vec3 p)\n{\n"
            "    return textureLod(medium_%zu_grid, p * medium_%zu_grid_scale + medium_%zu_grid_first, 0.0).r;\n}\n",
            texture_unit_of_baked(i), i, i, i, i, i);
}
