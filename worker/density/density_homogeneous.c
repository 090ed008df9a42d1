// SPDX-License-Identifier: Apache-2.0
#include "worker/density/density_kind.h"
#include "worker/glsl/timeline_value.h"

static bool is_zero(const struct scene_density *density)
{
    return timeline_value_is_zero(&density->homogeneous.scale);
}

static void add_values(struct frame_uniforms *uniforms, const struct density_site *site)
{
    frame_uniforms_add(uniforms,
                       timeline_value(&site->source->density.homogeneous.scale, FRAME_VALUE_FLOAT,
                                      value_range_not_negative, "density.scale"),
                       "medium_%zu_scale", site->medium);
}

static const char *const *modules(const struct density_site *site)
{
    static const char *const none[] = {NULL};

    (void)site;
    return none;
}

static void write(FILE *out, const struct density_site *site)
{
    size_t i = site->medium;

    fprintf(out, "float medium_%zu_field(vec3 p)\n{\n    return 0.0;\n}\n", i);
    fprintf(out, "float medium_%zu_density(float field)\n{\n    return medium_%zu_scale;\n}\n", i, i);
    fprintf(out, "float medium_%zu_distance(float field)\n{\n    return -1.0;\n}\n", i);
}

static void add_majorant(struct frame_uniforms *uniforms, const struct density_site *site)
{
    frame_uniforms_add(uniforms,
                       timeline_value(&site->source->density.homogeneous.scale, FRAME_VALUE_FLOAT,
                                      value_range_not_negative, "density.scale"),
                       "medium_%zu_majorant", site->medium);
}

const struct density_kind density_kind_homogeneous = {
    .name = "homogeneous",
    .field_type = "float",
    .is_even = true,
    .is_zero = is_zero,
    .add_values = add_values,
    .modules = modules,
    .write = write,
    .add_majorant = add_majorant,
};
