// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/truth_lengths.h"

#include "core/base/alloc.h"
#include "core/job/job.h"
#include "reference/still.h"
#include "worker/scene/pixel_samples.h"

#include <math.h>
#include <stdlib.h>

enum { COLUMNS = 16, ROWS = 9 };

// A stretch of a ray through media.
struct stretch {
    double begin, end; // m along the ray
};

struct stretches {
    struct stretch list[SCENE_MEDIUM_LIMIT]; // ascending and disjoint
    size_t count;
};

struct sums {
    double camera, camera_count, light, light_weight;
};

static double full_at(const void *context, struct vec3 position, double time)
{
    (void)context;
    (void)position;
    (void)time;
    return 1.0;
}

// From the first to the last point where the medium can be: what it leaves empty between is not looked for.
static bool cross_medium(const struct still *still, const struct medium *medium, const struct ray *ray, double near,
                         double far, struct stretch *stretch)
{
    const struct bounds *bounds = &still->bounded[medium - still->media].bounds;
    struct span_list spans = {0};
    bool is_crossed;

    *stretch = (struct stretch){near, far};
    if (bounds->kind != SCENE_BOUNDS_NONE)
        return bounds_clip(bounds, ray, &stretch->begin, &stretch->end) && stretch->begin < stretch->end;
    medium->density.spans(medium->density.field, ray, near, far, &spans);
    is_crossed = spans.count > 0;
    if (is_crossed) *stretch = (struct stretch){spans.spans[0].begin, spans.spans[spans.count - 1].end};
    span_list_finish(&spans);
    return is_crossed;
}

static void insert(struct stretches *stretches, struct stretch stretch)
{
    struct stretch *list = stretches->list;
    size_t at = stretches->count, kept = 0;

    for (; at > 0 && list[at - 1].begin > stretch.begin; at--)
        list[at] = list[at - 1];
    list[at] = stretch;
    stretches->count++;
    for (size_t i = 1; i < stretches->count; i++)
        if (list[i].begin > list[kept].end)
            list[++kept] = list[i];
        else
            list[kept].end = fmax(list[kept].end, list[i].end);
    stretches->count = kept + 1;
}

static struct stretches cross_media(const struct still *still, const struct ray *ray, size_t region, double near,
                                    double far, bool varying_only)
{
    struct still_media media = still_media(still, region);
    struct stretches stretches = {.count = 0};

    for (size_t i = 0; i < media.count && near < far; i++) {
        struct stretch stretch;

        if (varying_only && media.list[i].density.column) continue;
        if (cross_medium(still, &media.list[i], ray, near, far, &stretch)) insert(&stretches, stretch);
    }
    return stretches;
}

static double sum_up(const struct stretches *stretches)
{
    double sum = 0.0;

    for (size_t i = 0; i < stretches->count; i++)
        sum += stretches->list[i].end - stretches->list[i].begin;
    return sum;
}

static double follow_to_light(const struct still *still, const struct light *light, struct vec3 from)
{
    struct light_arrival arrival = light_arrive(light, from);
    struct ray ray = {from, vec3_scale(arrival.travel, -1.0)};
    struct object_walk walk;
    double sum = 0.0;

    objects_walk(&still->objects, &ray, arrival.distance, &walk);
    for (size_t i = 0; i < walk.count; i++) {
        struct stretches stretches;

        if (objects_is_opaque(&still->objects, walk.pieces[i].region)) break;
        stretches = cross_media(still, &ray, walk.pieces[i].region, walk.pieces[i].begin, walk.pieces[i].end, true);
        sum += sum_up(&stretches);
    }
    return sum;
}

// Shadow rays start in the middle of each stretch.
static void follow(const struct still *still, const struct ray *ray, struct sums *sums)
{
    struct object_walk walk;
    double length = 0.0;

    objects_walk(&still->objects, ray, INFINITY, &walk);
    for (size_t i = 0; i < walk.count; i++) {
        const struct object_piece *piece = &walk.pieces[i];
        struct stretches stretches;

        if (objects_is_opaque(&still->objects, piece->region)) break;
        stretches = cross_media(still, ray, piece->region, fmax(piece->begin, still->camera.clip_near),
                                fmin(piece->end, still->camera.clip_far), false);
        length += sum_up(&stretches);
        for (size_t k = 0; k < stretches.count * still->light_count; k++) {
            struct stretch stretch = stretches.list[k / still->light_count];
            double weight = stretch.end - stretch.begin;
            struct vec3 middle = ray_at(ray, 0.5 * (stretch.begin + stretch.end));

            sums->light += weight * follow_to_light(still, &still->lights[k % still->light_count], middle);
            sums->light_weight += weight;
        }
    }
    sums->camera += length;
    sums->camera_count += length > 0.0;
}

struct truth_lengths truth_lengths_find(const struct job *job, const int32_t *frames, int frame_count)
{
    struct still *still = xcalloc(1, sizeof *still);
    struct still_inputs *inputs = xcalloc(1, sizeof *inputs);
    struct sums sums = {0};

    for (size_t i = 0; i < job->scene.medium_count; i++)
        inputs->functions[i].at = full_at;
    for (int f = 0; f < frame_count; f++) {
        still_init_with_inputs(still, job, pixel_samples_time(job, frames[f], 0), inputs);
        for (int i = 0; i < COLUMNS * ROWS; i++) {
            int column = i % COLUMNS, row = i / COLUMNS;
            struct ray ray = camera_pinhole_ray(&still->camera, (column + 0.5) / COLUMNS * job->width_px,
                                                (row + 0.5) / ROWS * job->height_px);

            follow(still, &ray, &sums);
        }
    }
    free(inputs);
    free(still);
    return (struct truth_lengths){sums.camera_count > 0.0 ? sums.camera / sums.camera_count : 0.0,
                                  sums.light_weight > 0.0 ? sums.light / sums.light_weight : 0.0};
}
