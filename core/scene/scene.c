// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.h"

#include "core/scene/input_path.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void visit_bounds(struct scene_bounds *bounds, scene_visitor *visit, void *user)
{
    visit("center", &bounds->center, user);
    visit("radius", &bounds->radius, user);
    visit("size", &bounds->size, user);
    visit("normal", &bounds->normal, user);
    visit("thickness", &bounds->thickness, user);
    visit("falloff", &bounds->falloff, user);
}

static void visit_noise(struct scene_noise *noise, scene_visitor *visit, void *user)
{
    visit("frequency", &noise->frequency, user);
    visit("lacunarity", &noise->lacunarity, user);
    visit("hurst", &noise->hurst, user);
    visit("bias", &noise->bias, user);
    visit("offset", &noise->offset, user);
    visit("axis", &noise->axis, user);
    visit("angle", &noise->angle, user);
    visit("scale", &noise->scale, user);
}

static void visit_density(struct scene_density *density, scene_visitor *visit, void *user)
{
    visit_bounds(&density->bounds, visit, user);
    switch (density->kind) {
    case SCENE_DENSITY_FOLD_FRACTAL:
        visit("offset", &density->fold_fractal.offset, user);
        visit("radius", &density->fold_fractal.radius, user);
        visit("rotate_x", &density->fold_fractal.rotate_x_rad, user);
        visit("rotate_y", &density->fold_fractal.rotate_y_rad, user);
        visit("exponent", &density->fold_fractal.exponent, user);
        visit("scale", &density->fold_fractal.scale, user);
        break;
    case SCENE_DENSITY_HOMOGENEOUS:
        visit("scale", &density->homogeneous.scale, user);
        break;
    case SCENE_DENSITY_NOISE:
        visit_noise(&density->noise, visit, user);
        break;
    case SCENE_DENSITY_GRID:
        visit("center", &density->grid.center, user);
        visit("scale", &density->grid.scale, user);
        visit("unit_distance", &density->grid.unit_distance, user);
        break;
    case SCENE_DENSITY_GLSL:
        visit("scale", &density->glsl.scale, user);
        break;
    }
}

static void visit_medium(struct scene_medium *medium, scene_visitor *visit, void *user)
{
    visit_density(&medium->density, visit, user);
    visit("sigma_s", &medium->sigma_s, user);
    visit("sigma_a", &medium->sigma_a, user);
    visit("emission", &medium->emission, user);
    visit("kelvin", &medium->blackbody.kelvin, user);
    visit("intensity", &medium->blackbody.intensity, user);
    for (size_t i = 0; i < medium->lobe_count; i++) {
        visit("g", &medium->lobes[i].g, user);
        visit("weight", &medium->lobes[i].weight, user);
    }
}

static void visit_object(struct scene_object *object, scene_visitor *visit, void *user)
{
    struct scene_material *material = &object->material;

    visit("albedo", &material->albedo, user);
    visit("specular", &material->specular, user);
    visit("reflectance", &material->reflectance, user);
    visit("ior", &material->ior, user);
    visit("f0", &material->f0, user);
    visit("f90", &material->f90, user);
    visit("roughness", &material->roughness, user);
}

static void visit_shape(struct scene_shape *shape, scene_visitor *visit, void *user)
{
    visit("center", &shape->center, user);
    visit("radius", &shape->radius, user);
    visit("size", &shape->size, user);
    visit("normal", &shape->normal, user);
}

void scene_visit_timelines(struct scene *scene, scene_visitor *visit, void *user)
{
    visit("position", &scene->camera.position, user);
    visit("target", &scene->camera.target, user);
    visit("up", &scene->camera.up, user);
    visit("fov", &scene->camera.fov, user);
    for (size_t i = 0; i < scene->light_count; i++) {
        visit("intensity", &scene->lights[i].intensity, user);
        visit("position", &scene->lights[i].position, user);
        visit("direction", &scene->lights[i].direction, user);
    }
    for (size_t i = 0; i < scene->medium_count; i++)
        visit_medium(&scene->media[i], visit, user);
    for (size_t i = 0; i < scene->shape_count; i++)
        visit_shape(&scene->shapes[i], visit, user);
    for (size_t i = 0; i < scene->object_count; i++)
        visit_object(&scene->objects[i], visit, user);
    visit("background", &scene->background, user);
}

static void finish_timeline(const char *name, struct timeline *timeline, void *user)
{
    (void)name;
    (void)user;
    timeline_finish(timeline);
}

static void finish_medium(struct scene_medium *medium)
{
    if (medium->density.kind == SCENE_DENSITY_GRID) {
        free(medium->density.grid.file);
        free(medium->density.grid.grid_name);
        free(medium->density.grid.points);
    }
    if (medium->density.kind == SCENE_DENSITY_GLSL) {
        free(medium->density.glsl.file);
        free(medium->density.glsl.source);
    }
    free(medium->blackbody.grid_name);
}

void scene_finish(struct scene *scene)
{
    scene_visit_timelines(scene, finish_timeline, NULL);
    for (size_t i = 0; i < scene->medium_count; i++)
        finish_medium(&scene->media[i]);
    for (size_t i = 0; i < scene->object_count; i++)
        free(scene->objects[i].material.texture.file);
    *scene = (struct scene){0};
}

static void note_motion(const char *name, struct timeline *timeline, void *user)
{
    bool *is_constant = user;

    (void)name;
    if (!timeline_is_constant(timeline)) *is_constant = false;
}

bool scene_is_constant(const struct scene *scene)
{
    bool is_constant = true;

    // The visitor only reads.
    scene_visit_timelines((struct scene *)scene, note_motion, &is_constant);
    for (size_t i = 0; i < scene->medium_count; i++)
        if (scene_density_is_sequence(&scene->media[i].density)) is_constant = false;
    return is_constant;
}

bool scene_density_is_sequence(const struct scene_density *density)
{
    return density->kind == SCENE_DENSITY_GLSL ||
           (density->kind == SCENE_DENSITY_GRID && input_path_is_sequence(density->grid.file));
}

bool scene_grid_is_vdb(const struct scene_grid *grid)
{
    return input_path_has_ending(grid->file, ".nvdb") || input_path_has_ending(grid->file, ".vdb");
}

bool scene_density_is_even(const struct scene_density *density)
{
    const struct timeline *falloff = &density->bounds.falloff;
    double value[3] = {0};

    if (density->kind != SCENE_DENSITY_HOMOGENEOUS || !timeline_is_constant(falloff)) return false;
    timeline_evaluate(falloff, 0.0, value);
    return value[0] == 0.0;
}

const char *scene_glsl_name(const struct scene_glsl *glsl)
{
    const char *slash = glsl->file ? strrchr(glsl->file, '/') : NULL;

    if (!glsl->file) return "density.source";
    return slash ? slash + 1 : glsl->file;
}

void scene_format_medium_place(const struct scene *scene, size_t medium, char *place, size_t size)
{
    size_t owner = scene->media[medium].owner;

    if (owner > 0)
        snprintf(place, size, "scene.objects[%zu].material.interior", owner - 1);
    else
        snprintf(place, size, "scene.media[%zu]", medium);
}

const char *scene_find_code(const struct scene *scene)
{
    for (size_t i = 0; i < scene->medium_count; i++)
        if (scene->media[i].density.kind == SCENE_DENSITY_GLSL) return scene_glsl_name(&scene->media[i].density.glsl);
    return NULL;
}
