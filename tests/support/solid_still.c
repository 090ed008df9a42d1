// SPDX-License-Identifier: Apache-2.0
#include "tests/support/solid_still.h"

#include <math.h>

void solid_still_init(struct still *still)
{
    *still = (struct still){.max_depth = 32, .is_complete = true};
    camera_pinhole_init(&still->camera, &(struct camera_pinhole_params){.position = {0.0, 0.0, 4.0},
                                                                        .up = {0.0, 1.0, 0.0},
                                                                        .fov_deg = 40.0,
                                                                        .width_px = 5,
                                                                        .height_px = 5,
                                                                        .clip_far = INFINITY});
}

size_t solid_still_add(struct still *still, const struct material *material, const struct shape *shapes, size_t count)
{
    struct objects *objects = &still->objects;
    size_t first = 0;

    if (objects->count > 0) {
        const struct object *last = &objects->list[objects->count - 1];

        first = last->first_shape + last->shape_count;
    }
    for (size_t i = 0; i < count; i++)
        objects->shapes[first + i] = shapes[i];
    objects->list[objects->count++] = (struct object){first, count, *material};
    return objects->count;
}

void solid_still_set_background(struct still *still, double radiance)
{
    still->has_background = true;
    for (int c = 0; c < 3; c++)
        still->background[c] = radiance;
}

struct medium *solid_still_fill(struct still *still, size_t region, double sigma_s, double sigma_a)
{
    static const struct density_homogeneous EVEN = {1.0};
    struct medium *medium = &still->media[still->medium_count++];

    *medium = (struct medium){.density = density_homogeneous(&EVEN), .region = region};
    for (int c = 0; c < 3; c++) {
        medium->sigma_s[c] = sigma_s;
        medium->sigma_a[c] = sigma_a;
    }
    return medium;
}

struct shape solid_sphere(double x, double y, double z, double radius)
{
    return (struct shape){.kind = SCENE_SHAPE_SPHERE, .center = {x, y, z}, .radius = radius};
}

struct shape solid_box(struct vec3 center, struct vec3 half)
{
    return (struct shape){.kind = SCENE_SHAPE_BOX, .center = center, .half = half};
}

struct shape solid_plane(struct vec3 position, struct vec3 normal)
{
    return (struct shape){.kind = SCENE_SHAPE_PLANE, .center = position, .normal = vec3_normalize(normal)};
}

struct material solid_glass(enum scene_fresnel fresnel, double ior)
{
    return (struct material){.kind = SCENE_MATERIAL_DIELECTRIC, .fresnel = {.kind = fresnel, .f90 = 1.0}, .ior = ior};
}

struct material solid_mirror(double reflectance)
{
    return (struct material){.kind = SCENE_MATERIAL_MIRROR, .reflectance = {reflectance, reflectance, reflectance}};
}

struct material solid_diffuse(double albedo)
{
    return (struct material){.kind = SCENE_MATERIAL_DIFFUSE, .albedo = {albedo, albedo, albedo}, .ior = 1.5};
}
