// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_pixels.h"

// True where a number of a material is not 0 at all times.
static bool is_used(const struct timeline *timeline)
{
    double value[3] = {0};

    timeline_evaluate(timeline, 0.0, value);
    return !timeline_is_constant(timeline) || value[0] > 0.0;
}

static bool is_rough(const struct scene_material *material)
{
    return is_used(&material->roughness) && (material->kind != SCENE_MATERIAL_DIFFUSE || is_used(&material->specular));
}

const char *job_pixels_obstacle(const struct scene *scene, enum job_method method)
{
    if (method == JOB_METHOD_TRACKING || method == JOB_METHOD_JITTERED) return job_method_name(method);
    for (size_t i = 0; i < scene->object_count; i++)
        if (is_rough(&scene->objects[i].material)) return "a rough surface";
    return NULL;
}
