// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "core/job/job.h"
#include "core/job/job_json.h"
#include "core/scene/light_rules.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

// Checks what scene.h promises about pointers and counts.
static void check_media(const struct job *job)
{
    for (size_t i = 0; i < job->scene.medium_count; i++) {
        const struct scene_density *density = &job->scene.media[i].density;
        bool is_grid = density->kind == SCENE_DENSITY_GRID;

        if (is_grid && (!density->grid.file || density->grid.point_count == 1)) abort();
        if (is_grid && (density->grid.point_count > 0) != (density->grid.points != NULL)) abort();
        if (density->kind == SCENE_DENSITY_GLSL && !density->glsl.file && !density->glsl.source) abort();
        if (density->kind == SCENE_DENSITY_GLSL && density->bounds.kind == SCENE_BOUNDS_NONE) abort();
        if (job->quality.method == JOB_METHOD_EQUIANGULAR && !scene_density_is_even(density)) abort();
    }
}

// Each shape has one object and each interior a dielectric one.
static void check_objects(const struct job *job)
{
    const struct scene *scene = &job->scene;
    size_t next = 0;

    for (size_t i = 0; i < scene->object_count; i++) {
        const struct scene_object *object = &scene->objects[i];

        if (object->first_shape != next || object->shape_count == 0) abort();
        if (!object->is_union && object->shape_count != 1) abort();
        if (object->material.texture.file && object->material.kind != SCENE_MATERIAL_DIFFUSE) abort();
        next += object->shape_count;
    }
    if (next != scene->shape_count || scene->shape_count > SCENE_SHAPE_LIMIT) abort();
    if (scene->object_count > 0 && job->quality.method == JOB_METHOD_RIEMANN) abort();
    for (size_t i = 0; i < scene->medium_count; i++) {
        size_t owner = scene->media[i].owner;

        if (owner > scene->object_count || (i > 0 && scene->media[i - 1].owner > owner)) abort();
        if (owner > 0 && scene->objects[owner - 1].material.kind != SCENE_MATERIAL_DIELECTRIC) abort();
    }
}

// A scene has one dome at most, and light of many directions or of several orders has random paths.
static void check_lights(const struct job *job)
{
    const struct scene *scene = &job->scene;
    bool is_walked = scene->orders > 1 || job->quality.method == JOB_METHOD_PATHS;
    size_t dome_count = 0;

    if (scene->orders < 1 || (scene->orders > SCENE_ORDER_LIMIT && scene->orders != SCENE_ORDERS_ALL)) abort();
    for (size_t i = 0; i < scene->light_count; i++) {
        const struct scene_light *light = &scene->lights[i];
        bool is_dome = light->kind == SCENE_LIGHT_DOME;

        dome_count += is_dome;
        if (light_rules_of(light->kind)->has_size && !is_walked) abort();
        if ((is_dome && light->dome.kind == SCENE_DOME_FILE) != (light->dome.image.file != NULL)) abort();
        if (is_dome && light->dome.is_visible && scene->has_background) abort();
    }
    if (dome_count > 1) abort();
    if (job->quality.scatter_grid > 0 && (scene->orders == 1 || job->quality.paths == 0)) abort();
    for (size_t i = 0; i < scene->object_count && is_walked; i++)
        if (scene->objects[i].material.kind != SCENE_MATERIAL_DIFFUSE) abort();
}

// A job that is read can be evaluated at all its times; one that is refused has a reason and leaves nothing behind.
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct error error = {0};
    struct job job;
    double value[3];

    if (!job_parse(&job, (const char *)bytes, size, "/srv/out", &error)) {
        if (!error.message[0] || job.name || job.frames.spans || job.scene.light_count || job.scene.object_count)
            abort();
        return 0;
    }
    if (strlen(job.hash) != HASH_TEXT_SIZE - 1 || frame_range_count(&job.frames) < 1) abort();
    timeline_evaluate(&job.scene.camera.position, job_frame_time(&job, frame_range_at(&job.frames, 0)), value);
    if (!(value[0] - value[0] == 0.0)) abort();
    check_media(&job);
    check_objects(&job);
    check_lights(&job);
    job_finish(&job);
    return 0;
}
