// SPDX-License-Identifier: Apache-2.0
#include "core/scene/material_json.h"

#include "core/scene/medium_json.h"
#include "core/scene/scene.h"
#include "core/scene/scene_reader.h"
#include "core/scene/texture_json.h"

static const struct timeline_limits REFLECTANCE = {.min = 0.0, .max = 1.0};
static const struct timeline_limits IOR = {.components = 1, .min = 0.1, .max = 10.0};

static const double SPECULAR_IOR = 1.5;

static struct timeline constant(double value)
{
    return (struct timeline){.component_count = 1, .value = {value}};
}

static bool read_fresnel(const struct scene_reader *reader, struct scene_material *material)
{
    static const char *const fresnels[] = {"exact", "schlick", "none", NULL};
    static const char *const schlick_keys[] = {"f0", "f90"};
    int choice = SCENE_FRESNEL_EXACT;

    if (!scene_reader_read_choice(reader, "fresnel", fresnels, &choice)) return false;
    material->fresnel = (enum scene_fresnel)choice;
    for (size_t i = 0; i < sizeof schlick_keys / sizeof schlick_keys[0]; i++) {
        struct json_node node = json_node_child(reader->object, schlick_keys[i]);

        if (!json_node_is_absent(&node) && material->fresnel != SCENE_FRESNEL_SCHLICK)
            return json_fail(&node, reader->error, "only beside a fresnel of \"schlick\"");
    }
    material->has_f0 = scene_reader_has_key(reader, "f0");
    return scene_reader_read_or(reader, "f0", &SCENE_SHARE, 0.0, &material->f0) &&
           scene_reader_read_or(reader, "f90", &SCENE_SHARE, 1.0, &material->f90);
}

static bool read_roughness(const struct scene_reader *reader, struct scene_material *material)
{
    return scene_reader_read_or(reader, "roughness", &SCENE_SHARE, 0.0, &material->roughness);
}

static bool read_specular(const struct scene_reader *reader, struct scene_material *material)
{
    static const char *const keys[] = {"fresnel", "ior", "f0", "f90", "roughness"};

    if (!scene_reader_has_key(reader, "specular"))
        for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
            struct json_node node = json_node_child(reader->object, keys[i]);

            if (!json_node_is_absent(&node)) return json_fail(&node, reader->error, "only beside specular");
        }
    return scene_reader_read_or(reader, "specular", &SCENE_SHARE, 0.0, &material->specular) &&
           read_fresnel(reader, material) && scene_reader_read_or(reader, "ior", &IOR, SPECULAR_IOR, &material->ior) &&
           read_roughness(reader, material);
}

// True when a texture on the object has tiles; around a sphere it goes once.
static bool takes_tiles(const struct scene *scene, const struct scene_object *object)
{
    for (size_t i = 0; i < object->shape_count; i++)
        if (scene->shapes[object->first_shape + i].kind != SCENE_SHAPE_SPHERE) return true;
    return false;
}

static bool read_diffuse(const struct scene *scene, struct scene_object *object, const struct scene_reader *reader)
{
    static const char *const keys[] = {"kind", "albedo", "texture", "specular",  "fresnel",
                                       "ior",  "f0",     "f90",     "roughness", NULL};
    struct scene_material *material = &object->material;

    if (!json_check_keys(reader->object, keys, reader->error) ||
        !texture_from_json(&material->texture, reader, takes_tiles(scene, object)))
        return false;
    return (material->texture.file ? scene_reader_read_or(reader, "albedo", &REFLECTANCE, 1.0, &material->albedo)
                                   : scene_reader_read(reader, "albedo", &REFLECTANCE, &material->albedo)) &&
           read_specular(reader, material);
}

static bool read_mirror(struct scene_material *material, const struct scene_reader *reader)
{
    static const char *const keys[] = {"kind", "reflectance", "roughness", NULL};

    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read_or(reader, "reflectance", &REFLECTANCE, 1.0, &material->reflectance) &&
           read_roughness(reader, material);
}

static bool read_interior(struct scene *scene, size_t index, const struct scene_reader *material_reader)
{
    struct json_node object = json_node_child(material_reader->object, "interior");
    struct scene_reader reader = {&object, material_reader->span, material_reader->error};
    struct scene_medium *medium = &scene->media[scene->medium_count];

    if (json_node_is_absent(&object)) return true;
    if (scene->medium_count == SCENE_MEDIUM_LIMIT)
        return json_fail(&object, reader.error, "expected at most %d media, interiors among them", SCENE_MEDIUM_LIMIT);
    scene->medium_count++;
    medium->owner = index + 1;
    return medium_interior_from_json(medium, &reader);
}

static bool read_dielectric(struct scene *scene, size_t index, const struct scene_reader *reader)
{
    static const char *const keys[] = {"kind", "ior", "fresnel", "f0", "f90", "roughness", "interior", NULL};
    struct scene_material *material = &scene->objects[index].material;

    return json_check_keys(reader->object, keys, reader->error) &&
           scene_reader_read(reader, "ior", &IOR, &material->ior) && read_fresnel(reader, material) &&
           read_roughness(reader, material) && read_interior(scene, index, reader);
}

bool material_from_json(struct scene *scene, size_t index, const struct scene_reader *object_reader)
{
    static const char *const kinds[] = {"diffuse", "mirror", "dielectric", NULL};
    struct json_node object = json_node_child(object_reader->object, "material"),
                     kind = json_node_child(&object, "kind");
    struct scene_reader reader = {&object, object_reader->span, object_reader->error};
    struct scene_material *material = &scene->objects[index].material;
    int choice;

    if (!json_check_object(&object, reader.error) || !json_read_enum(&kind, kinds, &choice, reader.error)) return false;
    // Values that the kind does not have are set too.
    *material = (struct scene_material){.kind = (enum scene_material_kind)choice,
                                        .albedo = constant(1.0),
                                        .specular = constant(0.0),
                                        .reflectance = constant(1.0),
                                        .ior = constant(SPECULAR_IOR),
                                        .f0 = constant(0.0),
                                        .f90 = constant(1.0),
                                        .roughness = constant(0.0)};
    switch (material->kind) {
    case SCENE_MATERIAL_DIFFUSE:
        return read_diffuse(scene, &scene->objects[index], &reader);
    case SCENE_MATERIAL_MIRROR:
        return read_mirror(material, &reader);
    case SCENE_MATERIAL_DIELECTRIC:
        return read_dielectric(scene, index, &reader);
    }
    return false;
}
