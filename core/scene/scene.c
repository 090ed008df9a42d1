// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.h"

#include "core/scene/density_rules.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

static void visit_bounds(struct scene_bounds *bounds, timeline_visitor *visit, void *user)
{
    visit("center", &bounds->center, user);
    visit("radius", &bounds->radius, user);
    visit("size", &bounds->size, user);
    visit("normal", &bounds->normal, user);
    visit("thickness", &bounds->thickness, user);
    visit("falloff", &bounds->falloff, user);
}

static void visit_density(struct scene_density *density, timeline_visitor *visit, void *user)
{
    visit_bounds(&density->bounds, visit, user);
    density_rules_of(density)->visit(density, visit, user);
}

static void visit_medium(struct scene_medium *medium, timeline_visitor *visit, void *user)
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

static void visit_object(struct scene_object *object, timeline_visitor *visit, void *user)
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

static void visit_shape(struct scene_shape *shape, timeline_visitor *visit, void *user)
{
    visit("center", &shape->center, user);
    visit("radius", &shape->radius, user);
    visit("size", &shape->size, user);
    visit("normal", &shape->normal, user);
}

// Only kinds that have these visit them, so that the hashes of others stay.
static void visit_extent(struct scene_light *light, timeline_visitor *visit, void *user)
{
    switch (light->kind) {
    case SCENE_LIGHT_POINT:
    case SCENE_LIGHT_SUN:
        break;
    case SCENE_LIGHT_SPOT:
        visit("inner", &light->inner, user);
        visit("outer", &light->outer, user);
        break;
    case SCENE_LIGHT_SPHERE:
        visit("radius", &light->radius, user);
        break;
    case SCENE_LIGHT_DOME:
        visit("opposite", &light->dome.opposite, user);
        visit("axis", &light->dome.axis, user);
        visit("angle", &light->dome.angle, user);
        break;
    }
}

void scene_visit_timelines(struct scene *scene, timeline_visitor *visit, void *user)
{
    visit("position", &scene->camera.position, user);
    visit("target", &scene->camera.target, user);
    visit("up", &scene->camera.up, user);
    visit("fov", &scene->camera.fov, user);
    for (size_t i = 0; i < scene->light_count; i++) {
        visit("intensity", &scene->lights[i].intensity, user);
        visit("position", &scene->lights[i].position, user);
        visit("direction", &scene->lights[i].direction, user);
        visit_extent(&scene->lights[i], visit, user);
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
    const struct density_rules *rules = density_rules_of(&medium->density);

    if (rules->finish) rules->finish(&medium->density);
    free(medium->blackbody.grid_name);
}

void scene_finish(struct scene *scene)
{
    scene_visit_timelines(scene, finish_timeline, NULL);
    for (size_t i = 0; i < scene->medium_count; i++)
        finish_medium(&scene->media[i]);
    for (size_t i = 0; i < scene->object_count; i++)
        free(scene->objects[i].material.texture.file);
    for (size_t i = 0; i < scene->light_count; i++)
        free(scene->lights[i].dome.image.file);
    *scene = (struct scene){0};
}

void scene_add_vacuum(struct scene *scene)
{
    const struct timeline zero = {.component_count = 1}, one = {.component_count = 1, .value = {1.0}};

    assert(scene->medium_count == 0);
    scene->media[scene->medium_count++] = (struct scene_medium){.density = {.kind = SCENE_DENSITY_HOMOGENEOUS,
                                                                            .bounds = {.kind = SCENE_BOUNDS_SPHERE,
                                                                                       .center = {.component_count = 3},
                                                                                       .radius = one,
                                                                                       .falloff = zero},
                                                                            .homogeneous.scale = one},
                                                                .sigma_s = zero,
                                                                .sigma_a = zero,
                                                                .emission = zero};
    scene->has_vacuum = true;
}

void scene_format_orders(int orders, char text[static SCENE_ORDERS_SIZE])
{
    if (orders == SCENE_ORDERS_ALL)
        snprintf(text, SCENE_ORDERS_SIZE, "all");
    else
        snprintf(text, SCENE_ORDERS_SIZE, "%d", orders);
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
    const struct density_rules *rules = density_rules_of(density);

    return rules->is_sequence && rules->is_sequence(density);
}

bool scene_density_is_even(const struct scene_density *density)
{
    const struct timeline *falloff = &density->bounds.falloff;
    double value[3] = {0};

    if (!density_rules_of(density)->is_even || !timeline_is_constant(falloff)) return false;
    timeline_evaluate(falloff, 0.0, value);
    return value[0] == 0.0;
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

bool scene_media_are_even(const struct scene *scene)
{
    bool is_even = true;

    for (size_t i = 0; i < scene->medium_count; i++)
        is_even = is_even && scene_density_is_even(&scene->media[i].density);
    return is_even;
}

bool scene_has_behind(const struct scene *scene)
{
    for (size_t i = 0; i < scene->light_count; i++)
        if (scene->lights[i].dome.is_visible) return true;
    return scene->has_background;
}
