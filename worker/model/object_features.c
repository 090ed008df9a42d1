// SPDX-License-Identifier: Apache-2.0
#include "worker/model/object_features.h"

#include "worker/glsl/timeline_value.h"

static struct object_features diffuse_features_of(const struct scene_material *material)
{
    bool is_lit = material->texture.file || !timeline_value_is_zero(&material->albedo);
    bool reflects = !timeline_value_is_zero(&material->specular);

    return (struct object_features){.is_opaque = true,
                                    .is_lit = is_lit,
                                    .reflects = reflects,
                                    .has_fresnel = reflects,
                                    .is_grey = !material->texture.file && timeline_value_is_grey(&material->albedo)};
}

static struct object_features kind_features_of(const struct scene_material *material)
{
    switch (material->kind) {
    case SCENE_MATERIAL_DIFFUSE:
        return diffuse_features_of(material);
    case SCENE_MATERIAL_MIRROR:
        return (struct object_features){.is_opaque = true,
                                        .reflects = !timeline_value_is_zero(&material->reflectance),
                                        .is_grey = timeline_value_is_grey(&material->reflectance)};
    case SCENE_MATERIAL_DIELECTRIC:
        return (struct object_features){.reflects = true,
                                        .has_fresnel = true,
                                        .sends_two = material->fresnel != SCENE_FRESNEL_NONE,
                                        .is_grey = true};
    }
    return (struct object_features){.is_grey = true};
}

struct object_features object_features_of(const struct scene_material *material)
{
    struct object_features features = kind_features_of(material);

    features.is_rough = object_features_have_paths(&features) && !timeline_value_is_zero(&material->roughness);
    return features;
}

bool object_features_have_paths(const struct object_features *object)
{
    return object->reflects || !object->is_opaque;
}
