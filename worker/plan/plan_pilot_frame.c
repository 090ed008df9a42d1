// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_pilot_frame.h"

#include "core/base/error.h"
#include "worker/audit/audit.h"
#include "worker/audit/audit_map.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/image_exr.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_small.h"

#include <math.h>

// The accuracy asked of reference/, relative to the tolerance, and its limits. docs/rendering.md has the table of
// accuracies and times by which they were chosen.
static const double ACCURACY_SHARE = 0.5, ACCURACY_MIN = 1e-4, ACCURACY_MAX = 1e-2;

void plan_pilot_frame_finish(struct plan_pilot_frame *frame)
{
    image_finish(&frame->fine);
    image_finish(&frame->before);
    image_finish(&frame->seen);
}

static double squared_difference(const struct image *a, const struct image *b)
{
    size_t count = (size_t)a->width_px * (size_t)a->height_px;
    double sum = 0.0;

    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 3; c++) {
            double difference = (double)a->rgba[4 * i + c] - (b ? b->rgba[4 * i + c] : 0.0);

            sum += difference * difference / 3.0;
        }
    return sum / (double)count;
}

static double relative(double square, double mean_square)
{
    return sqrt(mean_square > AUDIT_BLACK * AUDIT_BLACK ? square / mean_square : square);
}

void plan_pilot_frame_keep(struct plan_pilot_frame *frame)
{
    struct image spare = frame->before;

    frame->before = frame->fine;
    frame->fine = frame->seen;
    frame->seen = spare;
    frame->mean_square = squared_difference(&frame->fine, NULL);
}

double plan_pilot_frame_change(const struct plan_pilot_frame *frame)
{
    return relative(squared_difference(&frame->fine, &frame->before), frame->mean_square);
}

void plan_pilot_frame_draw(struct plan_pilot_frame *frame, const struct job *job, size_t count)
{
    struct audit_map map;

    audit_map_init(&map, &(struct audit_map_params){.image = &frame->fine,
                                                    .pixel = JOB_PIXEL_FLOAT,
                                                    .finer = &frame->fine,
                                                    .coarser = &frame->before,
                                                    .is_own = true});
    audit_map_draw(&map, job, frame->number, 0, count, frame->points);
    frame->point_count = count;
    for (size_t k = 0; k < count; k++)
        frame->density[k] = audit_map_density(&map, frame->points[k]);
    audit_map_finish(&map);
}

bool plan_pilot_frame_measure(struct plan_pilot_frame *frame, const struct plan_params *params,
                              const struct plan_lattice *lattice, const struct job *job, enum renderer_fault *fault,
                              struct error *error)
{
    struct truth *truth =
        truth_open(&(struct truth_params){.job = job, .frame = frame->number, .is_for_plan = true}, error);
    double rms = sqrt(frame->mean_square);
    double wanted = ACCURACY_SHARE * params->job->quality.tolerance;
    const struct integrate_accuracy accuracy = {.relative = fmin(fmax(wanted, ACCURACY_MIN), ACCURACY_MAX),
                                                .floor = audit_map_floor(rms)};
    struct pixel pixels[PLAN_TRUE_PIXELS];
    size_t count = frame->point_count;

    if (!truth) {
        *fault = RENDERER_FAULT_FRAME;
        return false;
    }
    plan_lattice_find(lattice, frame->points, count, pixels);
    frame->true_count = truth_measure_many(truth, &(struct truth_many){.points = pixels,
                                                                       .pixels = frame->truth,
                                                                       .count = count,
                                                                       .accuracy = &accuracy,
                                                                       .on_progress = plan_small_on_pixel,
                                                                       .user = (void *)params});
    truth_close(truth);
    if (frame->true_count == count) return true;
    *fault = RENDERER_FAULT_STOPPED;
    error_set(error, "the frame was stopped");
    return false;
}

static const float *seen_at(const struct image *image, struct pixel point)
{
    return &image->rgba[4 * ((size_t)point.y * (size_t)image->width_px + (size_t)point.x)];
}

static double squared_distance(const float *seen, const double rgb[static 3])
{
    double sum = 0.0;

    for (int c = 0; c < 3; c++)
        sum += (seen[c] - rgb[c]) * (seen[c] - rgb[c]) / 3.0;
    return sum;
}

// The mean of |I - R|^2 for a render I and the light R, from the points where R is known. The means of |I - F|^2 over
// all pixels and over the points, F being the finest render, tell by how much the points are unlike the rest: as far as
// the two squares vary together. (Regression estimator: Cochran, Sampling Techniques, 1977.)
static double square_error(const struct plan_pilot_frame *frame)
{
    double near = squared_difference(&frame->seen, &frame->fine), count = (double)frame->true_count;
    double x = 0.0, y = 0.0, xy = 0.0, yy = 0.0, slope;

    for (size_t k = 0; k < frame->true_count; k++) {
        const float *seen = seen_at(&frame->seen, frame->points[k]), *fine = seen_at(&frame->fine, frame->points[k]);
        double from_light = squared_distance(seen, frame->truth[k].rgb) / frame->density[k];
        double from_fine = squared_distance(seen, (const double[]){fine[0], fine[1], fine[2]}) / frame->density[k];

        x += from_light / count;
        y += from_fine / count;
        xy += from_light * from_fine / count;
        yy += from_fine * from_fine / count;
    }
    if (frame->true_count == 0) return near;
    slope = yy > y * y ? fmin(fmax((xy - x * y) / (yy - y * y), 0.0), 1.0) : 0.0;
    // The correction may be larger than the mean.
    return fmax(x + slope * (near - y), 0.25 * x);
}

double plan_pilot_frame_error(const struct plan_pilot_frame *frame)
{
    return relative(square_error(frame), frame->mean_square);
}

void plan_pilot_frame_fill(const struct plan_pilot_frame *frame, enum job_pixel pixel, struct audit_pool *pool)
{
    double mean_square = squared_difference(&frame->seen, NULL);
    double change = relative(squared_difference(&frame->seen, &frame->fine), frame->mean_square);

    if (change > pool->change) pool->change = change;
    for (size_t k = 0; k < frame->true_count; k++) {
        const float *seen = seen_at(&frame->seen, frame->points[k]);
        double weight = 1.0 / (3.0 * frame->density[k] * (mean_square > AUDIT_BLACK * AUDIT_BLACK ? mean_square : 1.0));
        struct audit_sample sample = {0};

        for (int c = 0; c < 3; c++) {
            double value = image_exr_stored(seen[c], pixel);
            double difference = value - frame->truth[k].rgb[c];

            sample.square += weight * difference * difference;
            sample.cross += weight * value * difference;
        }
        audit_samples_append(&pool->samples, &sample);
    }
}
