// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_hash.h"

#include "core/job/job.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Changes whenever the same job comes to mean another picture, so that no frame of an earlier meaning passes for one.
static const char FORMAT[] = "marchd picture 2";

static void put_numbers(FILE *text, const char *key, const double *numbers, int count)
{
    fprintf(text, " %s", key);
    for (int i = 0; i < count; i++)
        fprintf(text, " %.17g", numbers[i] + 0.0); // turns -0 into 0
}

static void put_timeline(FILE *text, const char *key, const struct timeline *timeline)
{
    int count = timeline->component_count;

    fprintf(text, "%s %d %d", key, (int)timeline->kind, count);
    switch (timeline->kind) {
    case TIMELINE_CONSTANT:
        put_numbers(text, "value", timeline->value, count);
        break;
    case TIMELINE_LINEAR:
        put_numbers(text, "start", timeline->linear.start, count);
        put_numbers(text, "rate", timeline->linear.rate, count);
        break;
    case TIMELINE_LISSAJOUS:
        put_numbers(text, "center", timeline->lissajous.center, count);
        put_numbers(text, "amplitude", timeline->lissajous.amplitude, count);
        put_numbers(text, "frequency", timeline->lissajous.frequency_rad, count);
        put_numbers(text, "phase", timeline->lissajous.phase_rad, count);
        put_numbers(text, "speed", &timeline->lissajous.speed, 1);
        break;
    case TIMELINE_KEYS:
        fprintf(text, " interpolation %d", (int)timeline->keys.interpolation);
        for (size_t i = 0; i < timeline->keys.count; i++) {
            put_numbers(text, "time", &timeline->keys.keys[i].time, 1);
            put_numbers(text, "value", timeline->keys.keys[i].value, count);
        }
        break;
    case TIMELINE_ORBIT:
        put_numbers(text, "center", timeline->orbit.center, 3);
        put_numbers(text, "axis", timeline->orbit.axis, 3);
        put_numbers(text, "radius", &timeline->orbit.radius, 1);
        put_numbers(text, "height", &timeline->orbit.height, 1);
        put_numbers(text, "period", &timeline->orbit.period, 1);
        put_numbers(text, "phase", &timeline->orbit.phase_rad, 1);
        break;
    }
    fputc('\n', text);
}

static void put_visited(const char *name, struct timeline *timeline, void *user)
{
    put_timeline(user, name, timeline);
}

// Length first: no text runs into what follows.
static void put_text(FILE *text, const char *key, const char *value)
{
    fprintf(text, " %s %zu %s", key, value ? strlen(value) : 0, value ? value : "");
}

static void put_grid(FILE *text, const struct scene_grid *grid)
{
    const struct scene_raw *raw = &grid->raw;

    put_text(text, "file", grid->file);
    put_text(text, "grid", grid->grid_name);
    fprintf(text, " size %d %d %d type %d %d big %d skip %" PRId64 " nearest %d center %d points %zu", raw->size[0],
            raw->size[1], raw->size[2], raw->has_type, (int)raw->type, raw->is_big_endian, raw->skip_bytes,
            grid->is_nearest, grid->has_center, grid->point_count);
    put_numbers(text, "spacing", grid->spacing, 3);
    for (size_t i = 0; i < grid->point_count; i++) {
        put_numbers(text, "value", &grid->points[i].value, 1);
        put_numbers(text, "rgba", grid->points[i].rgba, 4);
    }
}

static void put_density(FILE *text, const struct scene_density *density)
{
    fprintf(text, "density %d bounds %d", (int)density->kind, (int)density->bounds.kind);
    switch (density->kind) {
    case SCENE_DENSITY_FOLD_FRACTAL:
        fprintf(text, " iterations %d", density->fold_fractal.iterations);
        break;
    case SCENE_DENSITY_NOISE:
        fprintf(text, " octaves %d mode %d", density->noise.octaves, (int)density->noise.mode);
        break;
    case SCENE_DENSITY_GRID:
        put_grid(text, &density->grid);
        break;
    case SCENE_DENSITY_GLSL:
        put_text(text, "source", density->glsl.source);
        put_numbers(text, "lipschitz", &density->glsl.lipschitz, 1);
        if (density->glsl.majorant > 0.0) put_numbers(text, "majorant", &density->glsl.majorant, 1);
        break;
    case SCENE_DENSITY_HOMOGENEOUS:
        break;
    }
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
    put_text(text, "texture", texture->file);
    put_numbers(text, "size", texture->size, 2);
    fputc('\n', text);
}

static void put_scene(FILE *text, const struct scene *scene)
{
    put_numbers(text, "clip", (double[]){scene->camera.clip_near, scene->camera.clip_far}, 2);
    put_numbers(text, "shutter", &scene->camera.shutter, 1);
    fprintf(text, " mirror %d background %d\n", scene->camera.mirror, scene->has_background);
    for (size_t i = 0; i < scene->light_count; i++)
        fprintf(text, "light %d falloff %d\n", (int)scene->lights[i].kind, (int)scene->lights[i].falloff);
    for (size_t i = 0; i < scene->medium_count; i++) {
        const struct scene_medium *medium = &scene->media[i];

        fprintf(text, "medium emission %d", medium->has_emission);
        if (medium->owner > 0) fprintf(text, " owner %zu", medium->owner);
        put_text(text, "blackbody", medium->blackbody.grid_name);
        fprintf(text, " lobes");
        for (size_t k = 0; k < medium->lobe_count; k++)
            fprintf(text, " %d", (int)medium->lobes[k].kind);
        fputc('\n', text);
        put_density(text, &medium->density);
    }
    for (size_t i = 0; i < scene->object_count; i++)
        put_object(text, scene, &scene->objects[i]);
    // With the counts and kinds above it is known which values come here; the visitor only reads.
    scene_visit_timelines((struct scene *)scene, put_visited, text);
}

// Numbers that methods later than the format's first have.
static void put_later_quality(FILE *text, const struct job_quality *quality)
{
    fprintf(text, " order %d light_grid %d density_grid %d estimator %s", quality->order, quality->light_grid,
            quality->density_grid, job_estimator_name(quality->estimator));
    put_numbers(text, "tolerance", &quality->tolerance, 1);
    put_numbers(text, "depth_step", &quality->depth_step, 1);
}

static void put_quality(FILE *text, const struct job_quality *quality)
{
    fprintf(text, "\nmethod %s light_steps %d points %d samples %d", job_method_name(quality->method),
            quality->light_steps, quality->points, quality->samples);
    put_numbers(text, "step", (double[]){quality->step, quality->step_voxels}, 2);
    put_numbers(text, "light_step", (double[]){quality->light_step, quality->light_step_voxels}, 2);
    put_numbers(text, "min_transmittance", &quality->min_transmittance, 1);
    put_numbers(text, "roulette", (double[]){quality->roulette_below, quality->roulette_survive}, 2);
    if (quality->method >= JOB_METHOD_ADAPTIVE) put_later_quality(text, quality);
}

// Only where it counts. Which share of light may be cut changes no pixel: each file is held to it by what its header says.
static void put_paths(FILE *text, const struct job_quality *quality)
{
    fprintf(text, " max_depth %d", quality->max_depth);
    put_numbers(text, "min_throughput", &quality->min_throughput, 1);
}

void job_hash_picture(const struct job *job, char hash[static HASH_TEXT_SIZE])
{
    char *bytes = NULL;
    size_t size_bytes = 0;
    FILE *text = open_memstream(&bytes, &size_bytes);

    if (!text) abort();
    fprintf(text, "%s\nresolution %d %d fps %" PRId64 " %" PRId64, FORMAT, job->width_px, job->height_px,
            job->fps_numerator, job->fps_denominator);
    put_numbers(text, "time_offset", &job->time_offset, 1);
    put_quality(text, &job->quality);
    if (job->scene.object_count > 0) put_paths(text, &job->quality);
    fprintf(text, "\npixel %d depth %d transmittance %d\n", (int)job->output.pixel, job->output.has_depth,
            job->output.has_transmittance);
    put_scene(text, &job->scene);
    if (fclose(text) != 0) abort();
    hash_bytes(bytes, size_bytes, hash);
    free(bytes);
}
