// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_probe.h"

#include "worker/audit/audit.h"
#include "worker/picture/image.h"
#include "worker/plan/finite_check.h"
#include "worker/plan/miss.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_retry.h"
#include "worker/plan/scatter_march.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    PART = 9,        // of the frame's rays that an axis is tried with
    PIXELS_MIN = 192 // fewer pixels say little, however many samples each has
};

// By how much a picture changes when its steps are doubled or halved, relative to its error: that falls with their
// length to the power of 1.5, as plan_retry_refine has it.
static const double DOUBLED = 1.8284271247461901, HALVED = 0.64644660940672624;
// The least throughput of a picture that stands for the truth, relative to the frame's.
static const double LEAST_THROUGHPUT = 1.0 / 256.0;

static void init_lattice(struct plan_lattice *lattice, const struct job *job, double rays)
{
    plan_lattice_init(lattice, job, (int)fmax(rays / job->quality.samples, fmin(rays, PIXELS_MIN)));
}

void plan_probe_init_lattice(struct plan_lattice *lattice, const struct job *job, const struct image *frame)
{
    init_lattice(lattice, job, (double)job->width_px * job->height_px / PART);
    plan_lattice_seek_light(lattice, frame);
}

// Copies the lattice's pixels of the frame.
static bool pick(const struct plan_lattice *lattice, const struct image *frame, struct image *picked,
                 struct error *error)
{
    size_t count = plan_lattice_count(lattice);

    if (!image_init(picked, lattice->columns, lattice->rows, false, false, error)) return false;
    for (size_t i = 0; i < count; i++) {
        struct pixel at = lattice->pixels[i];

        memcpy(&picked->rgba[4 * i], &frame->rgba[4 * ((size_t)at.y * (size_t)frame->width_px + (size_t)at.x)],
               4 * sizeof(float));
    }
    return true;
}

// What the lattice's pixels show by the plan, all of them traced.
static bool trace(const struct plan_probe *probe, const struct plan_lattice *lattice, struct image *seen,
                  enum renderer_fault *fault, struct error *error)
{
    struct job planned = plan_apply(probe->plan, probe->params->job);
    struct renderer_result result;
    bool ok = plan_list_render(probe->params, &planned, probe->frame, lattice->pixels, lattice->columns, lattice->rows,
                               seen, &result, error);

    *fault = result.fault;
    return ok;
}

// The same of the plan that the frame has: pixels that are interpolated in it are traced.
static bool see(const struct plan_probe *probe, const struct plan_lattice *lattice, struct image *seen,
                enum renderer_fault *fault, struct error *error)
{
    *fault = RENDERER_FAULT_FRAME;
    if (!probe->image->doubts) return pick(lattice, probe->image, seen, error);
    return trace(probe, lattice, seen, fault, error);
}

// Of the difference between two pictures; `b` may be NULL, for a black one.
static double root_mean_square(const struct image *a, const struct image *b)
{
    size_t count = (size_t)a->width_px * (size_t)a->height_px;
    double sum = 0.0;

    for (size_t i = 0; i < 4 * count; i++) {
        double apart = (double)a->rgba[i] - (b ? b->rgba[i] : 0.0);

        if (i % 4 < 3) sum += apart * apart;
    }
    return sqrt(sum / (3.0 * (double)count));
}

// Renders the lattice's pixels as the plan varied along an axis has them; *change stays where that cannot be.
static bool try_axis(const struct plan_probe *probe, struct plan_retry *retry, const struct plan_lattice *lattice,
                     const struct plan *plan, int axis, const struct image *seen, double *change,
                     enum renderer_fault *fault, struct error *error)
{
    struct plan varied = *plan;
    struct image image = {0};
    struct renderer_result result;
    struct job job;

    plan_retry_vary(retry, &varied, axis);
    plan_retry_spend(retry, &varied, lattice->columns, lattice->rows);
    job = plan_apply(&varied, probe->params->job);
    if (plan_list_render(probe->params, &job, probe->frame, lattice->pixels, lattice->columns, lattice->rows, &image,
                         &result, error))
        *change = root_mean_square(&image, seen);
    *fault = result.fault;
    image_finish(&image);
    return !renderer_fault_is_final(*fault);
}

bool plan_probe_axes(const struct plan_probe *probe, struct plan_retry *retry, double changes[static PLAN_AXIS_LIMIT],
                     enum renderer_fault *fault, struct error *error)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_retry_axes(retry, probe->plan, axes);
    struct plan_lattice lattice;
    struct image seen = {0};
    bool ok;

    plan_probe_init_lattice(&lattice, probe->params->job, probe->image);
    ok = see(probe, &lattice, &seen, fault, error);
    if (ok) *fault = RENDERER_FAULT_NONE;
    for (int i = 0; ok && i < count; i++) {
        changes[i] = 0.0;
        ok = try_axis(probe, retry, &lattice, probe->plan, i, &seen, &changes[i], fault, error);
    }
    image_finish(&seen);
    plan_lattice_finish(&lattice);
    return ok;
}

bool plan_probe_march(const struct plan_probe *probe, struct plan_retry *retry, double changes[static PLAN_AXIS_LIMIT],
                      enum renderer_fault *fault, struct error *error)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_retry_axes(retry, probe->plan, axes);
    struct plan light = *probe->plan;
    struct plan_probe lightened = *probe;
    struct plan_lattice lattice;
    struct image seen = {0};
    double mean = 0.0;
    bool ok;

    scatter_march_lighten(axes, count, &light.point);
    light.quality = plan_family_quality(&plan_families[light.family], &retry->scene, &light.point);
    lightened.plan = &light;
    plan_probe_init_lattice(&lattice, probe->params->job, probe->image);
    ok = trace(&lightened, &lattice, &seen, fault, error);
    if (ok) mean = root_mean_square(&seen, NULL);
    for (int i = 0; ok && i < count && mean > 0.0; i++) {
        double change = 0.0;

        if (!scatter_march_has(axes[i])) continue;
        ok = try_axis(&lightened, retry, &lattice, &light, i, &seen, &change, fault, error);
        changes[i] = change / mean / (light.point.rungs[i] >= PLAN_HALVING_RUNGS ? DOUBLED : HALVED);
    }
    image_finish(&seen);
    plan_lattice_finish(&lattice);
    return ok || !renderer_fault_is_final(*fault);
}

void plan_probe_init_audit(struct plan_lattice *lattice, const struct job *job, const struct plan_view *view)
{
    init_lattice(lattice, job, (double)view->finer.width_px * view->finer.height_px);
}

bool plan_probe_render_truth(const struct plan_params *params, const struct plan *plan, int32_t frame,
                             const struct plan_lattice *lattice, struct image *image, struct renderer_result *result,
                             struct error *error)
{
    struct plan halved = *plan;
    struct job job;
    size_t index;

    (void)plan_refine(&halved, params->job, PLAN_HALVING_RUNGS);
    job = plan_apply(&halved, params->job);
    for (size_t i = 0; i < job.scene.medium_count; ++i)
        if (miss_has_promise(&job.scene.media[i].density)) job.scene.media[i].density.glsl.lipschitz = 0.0;
    job.quality.max_depth = JOB_DEPTH_LIMIT;
    job.quality.min_throughput *= LEAST_THROUGHPUT;
    if (!plan_list_render(params, &job, frame, lattice->pixels, lattice->columns, lattice->rows, image, result, error))
        return false;
    if (!finite_check_find(image, &index)) return true;
    finite_check_tell(params->renderer, &job, frame, lattice->pixels[index], error);
    result->fault = RENDERER_FAULT_FRAME;
    return false;
}

bool plan_probe_audit(const struct plan_probe *probe, const struct plan_view *view, struct audit_result *audit,
                      enum renderer_fault *fault, struct error *error)
{
    struct image seen = {0}, finer = {0};
    struct plan_lattice lattice;
    bool ok;

    plan_probe_init_audit(&lattice, probe->params->job, view);
    ok = see(probe, &lattice, &seen, fault, error);
    if (ok) {
        struct renderer_result result;

        ok = plan_probe_render_truth(probe->params, probe->plan, probe->frame, &lattice, &finer, &result, error);
        *fault = result.fault;
    }
    if (ok) audit_by_halving(probe->params->job, &seen, &finer, audit);
    image_finish(&finer);
    image_finish(&seen);
    plan_lattice_finish(&lattice);
    return ok;
}
