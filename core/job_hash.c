#include "core/job_hash.h"

#include "core/job.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

// Changes whenever the same job comes to mean another picture, so that no frame of an earlier meaning passes for one.
static const char FORMAT[] = "marchd picture 1";

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

static void put_medium(FILE *text, const struct scene_medium *medium)
{
    const struct scene_fold_fractal *fold_fractal = &medium->density.fold_fractal;

    fprintf(text, "medium density %d iterations %d\n", (int)medium->density.kind, fold_fractal->iterations);
    put_timeline(text, "offset", &fold_fractal->offset);
    put_timeline(text, "radius", &fold_fractal->radius);
    put_timeline(text, "rotate_x", &fold_fractal->rotate_x_rad);
    put_timeline(text, "rotate_y", &fold_fractal->rotate_y_rad);
    put_timeline(text, "exponent", &fold_fractal->exponent);
    put_timeline(text, "scale", &fold_fractal->scale);
    put_timeline(text, "sigma_s", &medium->sigma_s);
    put_timeline(text, "sigma_a", &medium->sigma_a);
    if (medium->has_emission) put_timeline(text, "emission", &medium->emission);
    for (size_t i = 0; i < medium->lobe_count; i++) {
        put_timeline(text, "g", &medium->lobes[i].g);
        put_timeline(text, "weight", &medium->lobes[i].weight);
    }
}

static void put_scene(FILE *text, const struct scene *scene)
{
    put_timeline(text, "position", &scene->camera.position);
    put_timeline(text, "target", &scene->camera.target);
    put_timeline(text, "up", &scene->camera.up);
    put_timeline(text, "fov", &scene->camera.fov);
    put_numbers(text, "clip", (double[]){scene->camera.clip_near, scene->camera.clip_far}, 2);
    fprintf(text, " mirror %d\n", scene->camera.mirror);
    for (size_t i = 0; i < scene->light_count; i++) {
        const struct scene_light *light = &scene->lights[i];

        fprintf(text, "light %d falloff %d\n", (int)light->kind, (int)light->falloff);
        put_timeline(text, "intensity", &light->intensity);
        put_timeline(text, "position", &light->position);
        put_timeline(text, "direction", &light->direction);
    }
    for (size_t i = 0; i < scene->medium_count; i++)
        put_medium(text, &scene->media[i]);
    if (scene->has_background) put_timeline(text, "background", &scene->background);
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
    fprintf(text, "\nmethod %s light_steps %d", job_method_name(job->quality.method), job->quality.light_steps);
    put_numbers(text, "step", &job->quality.step, 1);
    put_numbers(text, "light_step", &job->quality.light_step, 1);
    put_numbers(text, "min_transmittance", &job->quality.min_transmittance, 1);
    fprintf(text, "\npixel %d depth %d transmittance %d\n", (int)job->output.pixel, job->output.has_depth,
            job->output.has_transmittance);
    put_scene(text, &job->scene);
    if (fclose(text) != 0) abort();
    hash_bytes(bytes, size_bytes, hash);
    free(bytes);
}
