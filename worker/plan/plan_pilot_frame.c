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
static const double ACCURACY_SHARE = 0.2, ACCURACY_MIN = 1e-4, ACCURACY_MAX = 1e-2;

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

void plan_pilot_frame_draw(struct plan_pilot_frame *frame, const struct job *job)
{
    struct audit_map map;

    audit_map_init(&map, &(struct audit_map_params){.image = &frame->fine,
                                                    .pixel = JOB_PIXEL_FLOAT,
                                                    .finer = &frame->fine,
                                                    .coarser = &frame->before,
                                                    .is_own = true});
    audit_map_draw(&map, job, frame->number, 0, PLAN_POINTS, frame->points);
    for (size_t k = 0; k < PLAN_POINTS; k++)
        frame->density[k] = audit_map_density(&map, frame->points[k]);
    audit_map_finish(&map);
}

double plan_pilot_frame_trace(struct plan_pilot_frame *frame, const struct image *image, bool is_first)
{
    double sum = 0.0;

    for (size_t k = 0; k < PLAN_POINTS; k++)
        for (size_t c = 0; c < 3; c++) {
            float value = image->rgba[4 * k + c];
            double change = is_first ? 0.0 : (double)value - frame->traced[k][c];

            sum += change * change / (3.0 * frame->density[k] * PLAN_POINTS);
            frame->traced[k][c] = value;
        }
    frame->is_traced = true;
    return relative(sum, frame->mean_square);
}

bool plan_pilot_frame_measure(struct plan_pilot_frame *frame, const struct plan_params *params,
                              const struct plan_lattice *lattice, const struct job *job, enum renderer_fault *fault,
                              struct error *error)
{
    struct truth *truth = truth_open(&(struct truth_params){.job = job, .frame = frame->number}, error);
    double rms = sqrt(frame->mean_square);
    double wanted = ACCURACY_SHARE * params->job->quality.tolerance;
    const struct integrate_accuracy accuracy = {.relative = fmin(fmax(wanted, ACCURACY_MIN), ACCURACY_MAX),
                                                .floor = audit_map_floor(rms)};
    struct pixel pixels[PLAN_TRUE_PIXELS];
    size_t count = PLAN_TRUE_PIXELS;

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

static double squared_distance_of_floats(const float *seen, const float *other)
{
    return squared_distance(seen, (const double[]){other[0], other[1], other[2]});
}

// The mean of |I - R|^2 for a render I and the light R. It is the mean of |I - F|^2 over all pixels, F being the finest
// render. It is corrected by |I - G|^2 - |I - F|^2 at the points, G being rendered without grids, and by
// |I - R|^2 - |I - G|^2 at those points where R is known. Each correction is without bias, however good the level
// before it is. (Multilevel Monte Carlo: Giles, Operations Research 56(3), 2008.)
static double square_error(const struct plan_pilot_frame *frame)
{
    double near = squared_difference(&frame->seen, &frame->fine), traced = 0.0, rest = 0.0;

    for (size_t k = 0; k < PLAN_POINTS && (frame->is_traced || k < frame->true_count); k++) {
        const float *seen = seen_at(&frame->seen, frame->points[k]);
        double from_fine = squared_distance_of_floats(seen, seen_at(&frame->fine, frame->points[k]));
        double from_traced = frame->is_traced ? squared_distance_of_floats(seen, frame->traced[k]) : from_fine;

        traced += (from_traced - from_fine) / frame->density[k];
        if (k < frame->true_count)
            rest += (squared_distance(seen, frame->truth[k].rgb) - from_traced) / frame->density[k];
    }
    if (frame->true_count == 0) return near;
    // The corrections by a few pixels may be larger than the mean.
    return fmax(near + traced / PLAN_POINTS + rest / (double)frame->true_count, 0.1 * near);
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
