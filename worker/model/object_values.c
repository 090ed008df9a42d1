// SPDX-License-Identifier: Apache-2.0
#include "worker/model/object_values.h"

#include "worker/glsl/timeline_value.h"
#include "worker/model/scene_features.h"

static const struct value_range shares = {0, 1};
static const struct value_range iors = {0.1, 10};
static const struct value_range unit = {-1.001, 1.001};

static void evaluate_half(const void *source, double time, double value[static 9])
{
    timeline_value_evaluate(source, time, value);
    for (int i = 0; i < 3; ++i)
        value[i] *= 0.5;
}

static void add_shape(struct frame_uniforms *uniforms, const struct scene_shape *shape, size_t i)
{
    const char *place = shape->kind == SCENE_SHAPE_PLANE ? "objects.point" : "objects.center";
    struct frame_value value;

    frame_uniforms_add(uniforms, timeline_value_position(&shape->center, place), "shape_%zu_center", i);
    switch (shape->kind) {
    case SCENE_SHAPE_SPHERE:
        value = timeline_value(&shape->radius, FRAME_VALUE_FLOAT, value_range_not_negative, "objects.radius");
        frame_uniforms_add(uniforms, value, "shape_%zu_radius", i);
        break;
    case SCENE_SHAPE_BOX:
        value = timeline_value(&shape->size, FRAME_VALUE_VEC3, value_range_not_negative, "objects.size");
        value.evaluate = evaluate_half;
        frame_uniforms_add(uniforms, value, "shape_%zu_half_size", i);
        break;
    case SCENE_SHAPE_PLANE:
        value = timeline_value(&shape->normal, FRAME_VALUE_VEC3, unit, "objects.normal");
        value.evaluate = timeline_value_evaluate_unit;
        frame_uniforms_add(uniforms, value, "shape_%zu_normal", i);
        break;
    }
}

static void add_fresnel(struct frame_uniforms *uniforms, const struct scene_material *material, size_t i)
{
    frame_uniforms_add(uniforms, timeline_value(&material->ior, FRAME_VALUE_FLOAT, iors, "material.ior"),
                       "object_%zu_ior", i);
    if (material->fresnel != SCENE_FRESNEL_SCHLICK) return;
    if (material->has_f0)
        frame_uniforms_add(uniforms, timeline_value(&material->f0, FRAME_VALUE_FLOAT, shares, "material.f0"),
                           "object_%zu_f0", i);
    frame_uniforms_add(uniforms, timeline_value(&material->f90, FRAME_VALUE_FLOAT, shares, "material.f90"),
                       "object_%zu_f90", i);
}

static void add_material(struct frame_uniforms *uniforms, const struct scene_material *material,
                         const struct object_features *features, enum frame_value_type spectrum, size_t i)
{
    if (features->has_fresnel) add_fresnel(uniforms, material, i);
    if (material->kind == SCENE_MATERIAL_MIRROR && features->reflects)
        frame_uniforms_add(uniforms, timeline_value(&material->reflectance, spectrum, shares, "material.reflectance"),
                           "object_%zu_reflectance", i);
    if (material->kind == SCENE_MATERIAL_DIFFUSE && features->reflects)
        frame_uniforms_add(uniforms,
                           timeline_value(&material->specular, FRAME_VALUE_FLOAT, shares, "material.specular"),
                           "object_%zu_specular", i);
    if (features->is_rough)
        frame_uniforms_add(uniforms,
                           timeline_value(&material->roughness, FRAME_VALUE_FLOAT, shares, "material.roughness"),
                           "object_%zu_roughness", i);
}

void object_values_add(struct frame_uniforms *uniforms, const struct scene *scene,
                       const struct scene_features *features, enum frame_value_type spectrum)
{
    for (size_t i = 0; i < scene->shape_count; ++i)
        add_shape(uniforms, &scene->shapes[i], i);
    for (size_t i = 0; i < scene->object_count; ++i) {
        const struct scene_material *material = &scene->objects[i].material;

        add_material(uniforms, material, &features->objects[i], spectrum, i);
        if (features->objects[i].is_lit && features->surfaces_are_lit)
            frame_uniforms_add(uniforms, timeline_value(&material->albedo, spectrum, shares, "material.albedo"),
                               "object_%zu_albedo", i);
    }
}
