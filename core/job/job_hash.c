// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_hash.h"

#include "core/base/hash_text.h"
#include "core/job/job.h"
#include "core/scene/density_rules.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

// Must change whenever a change of the code makes another picture of the same job, so that no older frame passes for a
// new one.
static const char FORMAT[] = "marchd picture 2";

static void put_timeline(FILE *text, const char *key, const struct timeline *timeline)
{
    int count = timeline->component_count;

    fprintf(text, "%s %d %d", key, (int)timeline->kind, count);
    switch (timeline->kind) {
    case TIMELINE_CONSTANT:
        hash_text_numbers(text, "value", timeline->value, count);
        break;
    case TIMELINE_LINEAR:
        hash_text_numbers(text, "start", timeline->linear.start, count);
        hash_text_numbers(text, "rate", timeline->linear.rate, count);
        break;
    case TIMELINE_LISSAJOUS:
        hash_text_numbers(text, "center", timeline->lissajous.center, count);
        hash_text_numbers(text, "amplitude", timeline->lissajous.amplitude, count);
        hash_text_numbers(text, "frequency", timeline->lissajous.frequency_rad, count);
        hash_text_numbers(text, "phase", timeline->lissajous.phase_rad, count);
        hash_text_numbers(text, "speed", &timeline->lissajous.speed, 1);
        break;
    case TIMELINE_KEYS:
        fprintf(text, " interpolation %d", (int)timeline->keys.interpolation);
        for (size_t i = 0; i < timeline->keys.count; i++) {
            hash_text_numbers(text, "time", &timeline->keys.keys[i].time, 1);
            hash_text_numbers(text, "value", timeline->keys.keys[i].value, count);
        }
        break;
    case TIMELINE_ORBIT:
        hash_text_numbers(text, "center", timeline->orbit.center, 3);
        hash_text_numbers(text, "axis", timeline->orbit.axis, 3);
        hash_text_numbers(text, "radius", &timeline->orbit.radius, 1);
        hash_text_numbers(text, "height", &timeline->orbit.height, 1);
        hash_text_numbers(text, "period", &timeline->orbit.period, 1);
        hash_text_numbers(text, "phase", &timeline->orbit.phase_rad, 1);
        break;
    }
    fputc('\n', text);
}

static void put_visited(const char *name, struct timeline *timeline, void *user)
{
    put_timeline(user, name, timeline);
}

static void put_density(FILE *text, const struct scene_density *density)
{
    const struct density_rules *rules = density_rules_of(density);

    fprintf(text, "density %d bounds %d", (int)density->kind, (int)density->bounds.kind);
    if (rules->write_hash_text) rules->write_hash_text(density, text);
    fputc('\n', text);
}

static void put_object(FILE *text, const struct scene *scene, const struct scene_object *object)
{
    const struct scene_material *material = &object->material;
    const struct scene_texture *texture = &material->texture;

    fprintf(text, "object shapes");
    for (size_t i = 0; i < object->shape_count; i++)
        fprintf(text, " %d", (int)scene->shapes[object->first_shape + i].kind);
    fprintf(text, " material %d fresnel %d f0 %d nearest %d linear %d", (int)material->kind, (int)material->fresnel,
            material->has_f0, texture->is_nearest, texture->is_linear);
    hash_text_string(text, "texture", texture->file);
    hash_text_numbers(text, "size", texture->size, 2);
    fputc('\n', text);
}

static void put_light(FILE *text, const struct scene_light *light)
{
    fprintf(text, "light %d falloff %d", (int)light->kind, (int)light->falloff);
    if (light->kind == SCENE_LIGHT_DOME) {
        fprintf(text, " dome %d visible %d", (int)light->dome.kind, light->dome.is_visible);
        hash_text_string(text, "file", light->dome.image.file);
    }
    fputc('\n', text);
}

static void put_scene(FILE *text, const struct scene *scene)
{
    hash_text_numbers(text, "clip", (double[]){scene->camera.clip_near, scene->camera.clip_far}, 2);
    hash_text_numbers(text, "shutter", &scene->camera.shutter, 1);
    fprintf(text, " mirror %d background %d\n", scene->camera.mirror, scene->has_background);
    for (size_t i = 0; i < scene->light_count; i++)
        put_light(text, &scene->lights[i]);
    if (scene->orders != 1) fprintf(text, "orders %d\n", scene->orders);
    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct scene_medium *medium = &scene->media[i];

        fprintf(text, "medium emission %d", medium->has_emission);
        if (medium->owner > 0) fprintf(text, " owner %zu", medium->owner);
        hash_text_string(text, "blackbody", medium->blackbody.grid_name);
        fprintf(text, " lobes");
        for (size_t k = 0; k < medium->lobe_count; k++)
            fprintf(text, " %d", (int)medium->lobes[k].kind);
        fputc('\n', text);
        put_density(text, &medium->density);
    }
    for (size_t i = 0; i < scene->object_count; i++)
        put_object(text, scene, &scene->objects[i]);
    // The counts and kinds above determine which values follow. The visitor only reads.
    scene_visit_timelines((struct scene *)scene, put_visited, text);
}

// Only methods from adaptive on have these: the hashes of earlier ones stay.
static void put_later_quality(FILE *text, const struct job_quality *quality)
{
    fprintf(text, " order %d light_grid %d density_grid %d estimator %s", quality->order, quality->light_grid,
            quality->density_grid, job_estimator_name(quality->estimator));
    hash_text_numbers(text, "tolerance", &quality->tolerance, 1);
    hash_text_numbers(text, "depth_step", &quality->depth_step, 1);
}

static void put_quality(FILE *text, const struct job_quality *quality)
{
    fprintf(text, "\nmethod %s light_steps %d points %d samples %d", job_method_name(quality->method),
            quality->light_steps, quality->points, quality->samples);
    hash_text_numbers(text, "step", (double[]){quality->step, quality->step_voxels}, 2);
    hash_text_numbers(text, "light_step", (double[]){quality->light_step, quality->light_step_voxels}, 2);
    hash_text_numbers(text, "min_transmittance", &quality->min_transmittance, 1);
    hash_text_numbers(text, "roulette", (double[]){quality->roulette_below, quality->roulette_survive}, 2);
    if (quality->method >= JOB_METHOD_ADAPTIVE) put_later_quality(text, quality);
    if (quality->paths > 0) fprintf(text, " scatter_grid %d paths %d", quality->scatter_grid, quality->paths);
    if (quality->scatter_from != JOB_SCATTER_FROM_ANY) fprintf(text, " from %d", (int)quality->scatter_from);
    if (quality->similar_after > 0) fprintf(text, " similar %d", quality->similar_after);
    if (quality->pixels.stride == 0) return;
    fprintf(text, " stride %d", quality->pixels.stride);
    hash_text_numbers(text, "threshold", &quality->pixels.threshold, 1);
}

// Only for scenes with objects. max_cut and on_miss change no pixel: the header of a file states its share of cut
// light, and whether it missed its tolerance.
static void put_paths(FILE *text, const struct job_quality *quality)
{
    fprintf(text, " max_depth %d", quality->max_depth);
    hash_text_numbers(text, "min_throughput", &quality->min_throughput, 1);
}

void job_hash_picture(const struct job *job, char hash[static HASH_TEXT_SIZE])
{
    char *bytes = NULL;
    size_t size_bytes = 0;
    FILE *text = open_memstream(&bytes, &size_bytes);

    if (!text) abort();
    fprintf(text, "%s\nresolution %d %d fps %" PRId64 " %" PRId64, FORMAT, job->width_px, job->height_px,
            job->fps_numerator, job->fps_denominator);
    hash_text_numbers(text, "time_offset", &job->time_offset, 1);
    put_quality(text, &job->quality);
    if (job->scene.object_count > 0) put_paths(text, &job->quality);
    fprintf(text, "\npixel %d depth %d transmittance %d\n", (int)job->output.pixel, job->output.has_depth,
            job->output.has_transmittance);
    put_scene(text, &job->scene);
    if (fclose(text) != 0) abort();
    hash_bytes(bytes, size_bytes, hash);
    free(bytes);
}
