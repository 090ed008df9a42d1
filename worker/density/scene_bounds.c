// SPDX-License-Identifier: Apache-2.0
#include "worker/density/scene_bounds.h"

#include "core/scene/scene.h"
#include "worker/glsl/timeline_value.h"

static const struct {
    const char *module, *name, *type, *size;
} kinds[] = {
    [SCENE_BOUNDS_NONE] = {NULL, NULL, NULL, NULL},
    [SCENE_BOUNDS_SPHERE] = {"region/sphere.glsl", "sphere", "RegionSphere", "radius"},
    [SCENE_BOUNDS_BOX] = {"region/box.glsl", "box", "RegionBox", "half_size"},
    [SCENE_BOUNDS_SLAB] = {"region/slab.glsl", "slab", "RegionSlab", "normal"},
};

const char *scene_bounds_module(const struct scene_bounds *bounds)
{
    return kinds[bounds->kind].module;
}

static void evaluate_half(const void *source, double time, double value[static 9])
{
    timeline_value_evaluate(source, time, value);
    for (int i = 0; i < 3; ++i)
        value[i] *= 0.5;
}

// A falloff of 0 becomes a length that a shader can divide by.
static void evaluate_falloff(const void *source, double time, double value[static 9])
{
    timeline_value_evaluate(source, time, value);
    if (value[0] == 0) value[0] = 1e-12;
}

static void add_half(struct frame_uniforms *uniforms, const struct timeline *timeline, enum frame_value_type type,
                     const char *meaning, const char *name, size_t medium)
{
    struct frame_value value = timeline_value(timeline, type, value_range_not_negative, meaning);

    value.evaluate = evaluate_half;
    frame_uniforms_add(uniforms, value, "medium_%zu_bounds_%s", medium, name);
}

static void add_slab(struct frame_uniforms *uniforms, const struct scene_bounds *bounds, size_t medium)
{
    static const struct value_range unit = {-1.001, 1.001};
    struct frame_value normal = timeline_value(&bounds->normal, FRAME_VALUE_VEC3, unit, "bounds.normal");

    normal.evaluate = timeline_value_evaluate_unit;
    frame_uniforms_add(uniforms, normal, "medium_%zu_bounds_normal", medium);
    add_half(uniforms, &bounds->thickness, FRAME_VALUE_FLOAT, "bounds.thickness", "half_thickness", medium);
}

void scene_bounds_add_values(struct frame_uniforms *uniforms, const struct scene_bounds *bounds, size_t medium)
{
    if (bounds->kind == SCENE_BOUNDS_NONE) return;
    frame_uniforms_add(uniforms, timeline_value_position(&bounds->center, "bounds.center"), "medium_%zu_bounds_center",
                       medium);
    if (bounds->kind == SCENE_BOUNDS_SPHERE)
        frame_uniforms_add(
            uniforms, timeline_value(&bounds->radius, FRAME_VALUE_FLOAT, value_range_not_negative, "bounds.radius"),
            "medium_%zu_bounds_radius", medium);
    else if (bounds->kind == SCENE_BOUNDS_BOX)
        add_half(uniforms, &bounds->size, FRAME_VALUE_VEC3, "bounds.size", "half_size", medium);
    else
        add_slab(uniforms, bounds, medium);
    if (!timeline_value_is_zero(&bounds->falloff)) {
        struct frame_value falloff =
            timeline_value(&bounds->falloff, FRAME_VALUE_FLOAT, value_range_positive, "bounds.falloff");

        falloff.evaluate = evaluate_falloff;
        frame_uniforms_add(uniforms, falloff, "medium_%zu_bounds_falloff", medium);
    }
}

void scene_bounds_write(FILE *out, const struct scene_bounds *bounds, bool has_falloff, size_t medium)
{
    const char *name = kinds[bounds->kind].name, *type = kinds[bounds->kind].type;

    fprintf(out, "%s medium_%zu_bounds()\n{\n", type, medium);
    fprintf(out, "    return %s(medium_%zu_bounds_center, medium_%zu_bounds_%s", type, medium, medium,
            kinds[bounds->kind].size);
    if (bounds->kind == SCENE_BOUNDS_SLAB) fprintf(out, ", medium_%zu_bounds_half_thickness", medium);
    fprintf(out, ");\n}\nvec2 medium_%zu_bounds_span(vec3 origin, vec3 direction)\n{\n", medium);
    fprintf(out, "    return region_%s_span(medium_%zu_bounds(), origin, direction);\n}\n", name, medium);
    if (!has_falloff) return;
    fprintf(out, "float medium_%zu_falloff(vec3 p)\n{\n", medium);
    fprintf(out, "    return smoothstep(0.0, medium_%zu_bounds_falloff, region_%s_depth(medium_%zu_bounds(), p));\n}\n",
            medium, name, medium);
}
