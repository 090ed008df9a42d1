// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/scatter_evidence.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "core/job/plan_json.h"
#include "worker/audit/audit.h"
#include "worker/audit/truth.h"
#include "worker/picture/audit_result.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_small.h"

#include <math.h>
#include <stdlib.h>

enum { FRAMES_LEAST = 12 }; // fewer do not repay it

struct measuring {
    const struct plan_params *params;
    struct plan_lattice lattice;
    struct job job;
    struct plan_evidence *evidence;
    enum renderer_fault *fault;
    struct error *error;
};

static bool measure_light(struct measuring *measuring, int32_t frame, double mean_square, struct truth_pixel *pixels)
{
    const struct plan_params *params = measuring->params;
    const struct integrate_accuracy accuracy = audit_accuracy(params->job->quality.tolerance, mean_square);
    size_t count = plan_lattice_count(&measuring->lattice), measured;
    struct truth *truth = truth_open(&(struct truth_params){.job = &measuring->job, .frame = frame}, measuring->error);

    *measuring->fault = RENDERER_FAULT_FRAME;
    if (!truth) return false;
    measured = truth_measure_many(truth, &(struct truth_many){.points = measuring->lattice.pixels,
                                                              .pixels = pixels,
                                                              .count = count,
                                                              .accuracy = &accuracy,
                                                              .on_progress = plan_small_on_pixel,
                                                              .user = (void *)params});
    truth_close(truth);
    if (measured == count) {
        *measuring->fault = RENDERER_FAULT_NONE;
        return true;
    }
    *measuring->fault = RENDERER_FAULT_STOPPED;
    error_set(measuring->error, "the frame was stopped");
    return false;
}

static double find_mean_square(const struct image *image)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    double sum = 0.0;

    for (size_t i = 0; i < 4 * count; i++)
        if (i % 4 != 3) sum += (double)image->rgba[i] * image->rgba[i];
    return sum / (3.0 * (double)count);
}

static bool has_light(double mean_square)
{
    return mean_square > AUDIT_BLACK * AUDIT_BLACK && isfinite(mean_square);
}

// As audit_map_compare has it: the light's noise counts nothing.
void scatter_evidence_add(const struct image *image, const struct pixel *points, const struct truth_pixel *light,
                          size_t count, enum job_pixel pixel, struct audit_pool *pool)
{
    double mean_square = find_mean_square(image), weight = 1.0 / (3.0 * mean_square);

    for (size_t i = 0; i < count && has_light(mean_square); i++) {
        size_t at = (size_t)points[i].y * (size_t)image->width_px + (size_t)points[i].x;
        struct audit_sample sample = {0};

        for (size_t c = 0; c < 3; c++) {
            double value = image_exr_stored(image->rgba[4 * at + c], pixel);
            double difference = value - light[i].rgb[c], half = light[i].half[c];

            sample.square += weight * (difference * difference - half * half);
            sample.cross += weight * value * difference;
        }
        audit_samples_append(&pool->samples, &sample);
    }
}

static bool measure_frame(struct measuring *measuring, int32_t frame)
{
    const struct plan_lattice *lattice = &measuring->lattice;
    size_t count = plan_lattice_count(lattice);
    size_t left = PLAN_JSON_SAMPLE_LIMIT - measuring->evidence->pool.samples.count; // lattices may have some too many
    struct truth_pixel *light = xcalloc(count, sizeof *light);
    struct image image = {0};
    struct renderer_result result;
    struct pixel *points = xcalloc(count, sizeof *points); // of the small picture
    bool ok = plan_list_render(measuring->params, &measuring->job, frame, lattice->pixels, lattice->columns,
                               lattice->rows, &image, &result, measuring->error);

    *measuring->fault = result.fault;
    for (size_t i = 0; i < count; i++)
        points[i] = (struct pixel){(int)i % lattice->columns, (int)i / lattice->columns};
    if (ok && has_light(find_mean_square(&image))) {
        ok = measure_light(measuring, frame, find_mean_square(&image), light);
        if (ok)
            scatter_evidence_add(&image, points, light, count < left ? count : left, measuring->job.output.pixel,
                                 &measuring->evidence->pool);
    }
    free(points);
    free(light);
    image_finish(&image);
    return ok || !renderer_fault_is_final(*measuring->fault);
}

bool scatter_evidence_measure(const struct plan *plan, const struct plan_params *params, struct plan_evidence *evidence,
                              enum renderer_fault *fault, struct error *error)
{
    const struct plan_segment *segment = &params->segment;
    struct measuring measuring = {
        .params = params, .evidence = evidence, .job = *params->job, .fault = fault, .error = error};
    bool ok = true;

    if (plan->quality.scatter_grid == 0 || segment->count < FRAMES_LEAST) return true;
    measuring.job.quality = plan->quality;
    plan_lattice_init(&measuring.lattice, params->job, PLAN_JSON_SAMPLE_LIMIT / segment->pilot_count);
    for (int i = 0; i < segment->pilot_count && ok; i++)
        ok = measure_frame(&measuring, segment->pilot[i]);
    plan_lattice_finish(&measuring.lattice);
    if (ok) {
        const struct audit_verdict verdict = audit_estimate(
            &(struct audit_evidence){.own = &evidence->pool.samples, .change = -1.0, .pool_change = -1.0});

        log_debug("plan: error in %zu pixels of its own: %.2e, a standard error more %.2e",
                  evidence->pool.samples.count, verdict.error, verdict.error + verdict.spread);
    }
    return ok;
}
