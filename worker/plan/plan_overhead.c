// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_overhead.h"

#include "core/base/clock.h"
#include "core/base/error.h"
#include "worker/audit/audit.h"
#include "worker/audit/audit_map.h"
#include "worker/audit/truth.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_params.h"
#include "worker/plan/plan_probe.h"
#include "worker/plan/plan_progress.h"
#include "worker/plan/plan_segment.h"
#include "worker/plan/plan_small.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

enum { PIXELS = 480 * 270 }; // of the small frame, at most
// A frame of random paths that is foretold to take longer than this is drawn with fewer: its file and its audit are
// timed, and not the frame.
static const double PICTURE_S = 2.0;

struct overhead {
    struct plan *plan;
    const struct plan_params *params;
    const struct plan_evidence *evidence;
    struct job job; // small, as planned; owns nothing
    int32_t frame;
    struct image image;
    clockid_t clock; // of processor time where processors render, else of wall time
    double ratio;    // pixels of the job's frames over those of the small frame
    struct renderer_result result;
    struct error *error;
};

static bool render(struct overhead *overhead, const struct job *job, struct image *image)
{
    return plan_small_render(overhead->params, job, overhead->frame, image, &overhead->result, overhead->error);
}

// Times writing the file and reading it back once, as the gate does, scaled to the job's size.
static bool time_file(struct overhead *overhead, double *seconds)
{
    struct image_exr_header header = {.pixel = overhead->job.output.pixel,
                                      .compression = overhead->job.output.compression,
                                      .fps_numerator = 24,
                                      .fps_denominator = 1,
                                      .job_hash = overhead->job.hash};
    double start_s = clock_read_s(overhead->clock);
    int fd = memfd_create("frame", MFD_CLOEXEC);
    bool is_finite;
    bool ok = fd >= 0 && image_exr_write(fd, &overhead->image, &header, 1, overhead->error) &&
              image_exr_scan(fd, &is_finite, 1, overhead->error);

    *seconds = (clock_read_s(overhead->clock) - start_s) * overhead->ratio;
    if (fd >= 0) close(fd);
    return ok;
}

// Times the audit. Building the map grows with the frame's pixels; the number of measured pixels does not.
static bool time_audit(struct overhead *overhead, double *seconds)
{
    const struct plan_view *view = plan_evidence_find(overhead->evidence, overhead->frame);
    struct truth *truth =
        truth_open(&(struct truth_params){.job = &overhead->job, .frame = overhead->frame}, overhead->error);
    struct audit_params params = {.job = &overhead->job,
                                  .frame = overhead->frame,
                                  .image = &overhead->image,
                                  .truth = truth,
                                  .pool = overhead->evidence->pool.samples.count > 0 ? &overhead->evidence->pool : NULL,
                                  .tolerance = overhead->params->job->quality.tolerance,
                                  .on_progress = plan_small_on_tile,
                                  .user = (void *)overhead->params};
    struct audit_map_params map_params = {.image = &overhead->image, .pixel = overhead->job.output.pixel};
    struct audit_result result;
    struct audit_map map;
    double start_s = clock_read_s(overhead->clock), map_s;
    bool ok;

    if (!truth) return false;
    if (view && view->finer.width_px <= overhead->job.width_px && view->finer.height_px <= overhead->job.height_px) {
        params.finer = map_params.finer = &view->finer;
        params.coarser = map_params.coarser = &view->coarser;
    }
    audit_map_init(&map, &map_params);
    audit_map_finish(&map);
    map_s = clock_read_s(overhead->clock) - start_s;
    ok = audit_frame(&params, &result);
    if (!ok) overhead->result.fault = RENDERER_FAULT_STOPPED;
    *seconds = clock_read_s(overhead->clock) - start_s - 2.0 * map_s + map_s * overhead->ratio;
    truth_close(truth);
    return ok;
}

// Times the audit by step halving, for the user's GLSL: a list of pixels.
static bool time_halving(struct overhead *overhead, double *seconds)
{
    const struct plan_view *view = plan_evidence_find(overhead->evidence, overhead->frame);
    double start_s = clock_read_s(overhead->clock);
    struct plan_lattice lattice;
    struct image image = {0};
    bool ok;

    *seconds = 0.0;
    if (!view) return true;
    plan_probe_init_audit(&lattice, overhead->params->job, view);
    ok = plan_probe_render_truth(overhead->params, overhead->plan, overhead->frame, &lattice, &image, &overhead->result,
                                 overhead->error);
    image_finish(&image);
    plan_lattice_finish(&lattice);
    *seconds = clock_read_s(overhead->clock) - start_s;
    return ok;
}

static void init(struct overhead *overhead)
{
    const struct job *job = overhead->params->job;
    struct job planned = plan_apply(overhead->plan, job);

    overhead->frame = overhead->params->segment.pilot[overhead->params->segment.pilot_count / 2];
    overhead->job = plan_small_job(&planned, plan_small_scale(job, PIXELS));
    overhead->ratio =
        (double)job->width_px * job->height_px / ((double)overhead->job.width_px * overhead->job.height_px);
    if (overhead->job.quality.paths > 0 && overhead->plan->predicted_s > PICTURE_S * overhead->ratio)
        overhead->job.quality.paths =
            (int)fmax(overhead->job.quality.paths * PICTURE_S * overhead->ratio / overhead->plan->predicted_s, 1.0);
    overhead->clock = renderer_is_software(overhead->params->renderer) ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
}

bool plan_overhead_predict(struct plan *plan, const struct plan_params *params, const struct plan_evidence *evidence,
                           enum renderer_fault *fault, struct error *error)
{
    struct overhead overhead = {.plan = plan, .params = params, .evidence = evidence, .error = error};
    bool is_software = renderer_is_software(params->renderer);
    double parallel = is_software && plan->predicted_s > 0.0 ? plan->predicted_processor_s / plan->predicted_s : 1.0;
    bool ok;

    init(&overhead);
    plan_progress_note(params, PLAN_STAGE_OVERHEAD, 0.0);
    ok = render(&overhead, &overhead.job, &overhead.image) && time_file(&overhead, &plan->predicted_encode_s) &&
         (truth_has_twin(params->job) ? time_audit : time_halving)(&overhead, &plan->predicted_audit_s);
    if (ok) {
        // Copies share one audit.
        plan->predicted_audit_s *= plan_segment_pictures(params->job, &params->segment) / (double)params->segment.count;
        plan->predicted_audit_s /= parallel;
        plan->predicted_encode_s /= parallel;
        plan->predicted_frame_s = plan->predicted_s + plan->predicted_audit_s;
        // The file of the frame before is written at the same time: by the same processors, or beside the GPU.
        plan->predicted_frame_s = is_software ? plan->predicted_frame_s + plan->predicted_encode_s
                                              : fmax(plan->predicted_frame_s, plan->predicted_encode_s);
    } else {
        *fault = overhead.result.fault == RENDERER_FAULT_NONE ? RENDERER_FAULT_FRAME : overhead.result.fault;
    }
    image_finish(&overhead.image);
    return ok;
}
