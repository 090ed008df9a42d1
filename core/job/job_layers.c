// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_layers.h"

bool job_layers_are_two(const struct job *job)
{
    const struct job_quality *quality = &job->quality;

    return quality->method == JOB_METHOD_PATHS && (quality->step > 0.0 || quality->step_voxels > 0.0 ||
                                                   quality->pixels.stride > 0 || scene_media_are_even(&job->scene));
}

static bool is_sky(const struct scene_light *light)
{
    return light->kind == SCENE_LIGHT_DOME && light->dome.is_visible;
}

static void keep_sky(struct scene *scene)
{
    size_t count = 0;

    for (size_t i = 0; i < scene->light_count; i++)
        if (is_sky(&scene->lights[i])) scene->lights[count++] = scene->lights[i];
    scene->light_count = count;
}

struct job job_layers_seen(const struct job *job)
{
    struct job seen = *job;

    seen.scene.orders = 1;
    keep_sky(&seen.scene);
    seen.quality.method = JOB_METHOD_MIDPOINT;
    seen.quality.paths = seen.quality.light_grid = 0;
    return seen;
}

struct job job_layers_scattered(const struct job *job)
{
    struct job scattered = *job;

    scattered.output.has_depth = false;
    scattered.output.has_transmittance = true;
    return scattered;
}

bool job_layers_have_sky(const struct job *job)
{
    bool has_sky = false;

    for (size_t i = 0; i < job->scene.light_count; i++)
        has_sky |= is_sky(&job->scene.lights[i]);
    return has_sky && job->quality.method != JOB_METHOD_PATHS && job->quality.pixels.stride > 0 &&
           job->scene.object_count == 0;
}

struct job job_layers_lit(const struct job *job)
{
    struct job lit = *job;

    for (size_t i = 0; i < lit.scene.light_count; i++)
        lit.scene.lights[i].dome.is_visible = false;
    lit.output.has_transmittance = true;
    return lit;
}

struct job job_layers_sky(const struct job *job)
{
    struct job sky = *job;

    keep_sky(&sky.scene);
    sky.scene.medium_count = 0;
    sky.scene.orders = 1;
    sky.quality = (struct job_quality){.method = JOB_METHOD_MIDPOINT, .samples = job->quality.samples};
    sky.output.has_depth = sky.output.has_transmittance = false;
    return sky;
}
