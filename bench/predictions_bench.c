// The predictions of plans beside measurements: predictions_bench WIDTH TOLERANCE JOB...
// SPDX-License-Identifier: Apache-2.0
// Each job is a row of a table, with its resolution scaled to WIDTH. Frames spread over the first segment give CPU
// seconds (wall clock seconds where a GPU renders) and the error of many pixels against reference/. A job with a user's
// own code is compared with a march in finer steps.
#include "cli/job/job_document.h"
#include "core/base/clock.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/audit/audit.h"
#include "worker/audit/truth.h"
#include "worker/gl/gl_context.h"
#include "worker/picture/image.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_make.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FRAMES = 8, RAYS = 192, FINER_RUNGS = 4 };

// The truth is measured as if this share of the tolerance were allowed, so that its own error does not show.
static const double EXACT_SHARE = 0.2;

struct stage {
    struct renderer *renderer;
    bool by_processor;
    struct job job;
    struct plan plan;
    struct plan_evidence evidence;
    struct truth *truth; // NULL: the density has no twin
    struct image image;
    double seconds, square; // sums over frames
    int frame_count, missed_count;
};

// Does the same as the command line.
static bool load_job(struct job *job, const char *path, int width_px, double tolerance, struct error *error)
{
    char *document = job_document_load(path, NULL, 0, error);
    bool ok = document && job_document_check(path, document, "/", job, error);
    struct job_quality *quality = &job->quality;

    free(document);
    if (!ok) return false;
    job->height_px = (int)round((double)job->height_px * width_px / job->width_px);
    job->width_px = width_px;
    *quality = (struct job_quality){.method = JOB_METHOD_AUTO,
                                    .tolerance = tolerance,
                                    .samples = quality->samples,
                                    .max_depth = quality->max_depth,
                                    .min_throughput = quality->min_throughput,
                                    .max_cut = 1.0};
    return true;
}

static bool render(struct stage *stage, const struct plan *plan, int32_t frame, struct image *image, double *seconds,
                   struct error *error)
{
    clockid_t clock = stage->by_processor ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
    struct job planned = plan_apply(plan, &stage->job);
    struct renderer_result result;
    double start_s = clock_read_s(clock);
    bool ok = renderer_render(
        stage->renderer, &(struct renderer_frame){.job = &planned, .frame = frame, .image = image}, &result, error);

    *seconds = clock_read_s(clock) - start_s;
    return ok;
}

static double find_difference(const struct image *image, const struct image *finer)
{
    double apart = 0.0, light = 0.0;

    for (size_t i = 0; i < 4 * (size_t)image->width_px * (size_t)image->height_px; i++) {
        double difference = (double)image->rgba[i] - finer->rgba[i];

        if (i % 4 == 3) continue; // alpha
        apart += difference * difference;
        light += (double)finer->rgba[i] * finer->rgba[i];
    }
    return sqrt(apart / light);
}

static bool measure_error(struct stage *stage, int32_t frame, double *found, struct error *error)
{
    const struct plan_view *view = plan_evidence_find(&stage->evidence, frame);
    struct plan finer = plan_of_frame(&stage->plan, &stage->job, frame);
    struct job planned = plan_apply(&finer, &stage->job);
    struct audit_params params = {.job = &planned,
                                  .frame = frame,
                                  .image = &stage->image,
                                  .truth = stage->truth,
                                  .tolerance = EXACT_SHARE * stage->job.quality.tolerance,
                                  .ray_min = RAYS,
                                  .ray_max = RAYS};
    struct audit_result result;
    struct image image = {0};
    double seconds;
    bool ok;

    if (stage->truth) {
        if (view) params.finer = &view->finer;
        if (view) params.coarser = &view->coarser;
        ok = truth_seek(stage->truth, frame, error) && audit_frame(&params, &result);
        *found = ok ? result.error : NAN;
        return ok;
    }
    (void)plan_refine(&finer, &stage->job, FINER_RUNGS);
    ok = image_init(&image, stage->job.width_px, stage->job.height_px, stage->job.output.has_depth,
                    stage->job.output.has_transmittance, error) &&
         render(stage, &finer, frame, &image, &seconds, error);
    *found = ok ? find_difference(&stage->image, &image) : NAN;
    image_finish(&image);
    return ok;
}

// The first frame links programs.
static bool measure(struct stage *stage, struct error *error)
{
    struct plan_segment segment = plan_segment_at(&stage->job, 0);
    struct job planned = plan_apply(&stage->plan, &stage->job);
    double seconds, found;

    if (truth_has_twin(&stage->job)) {
        stage->truth =
            truth_open(&(struct truth_params){.job = &planned, .frame = frame_range_at(&stage->job.frames, 0)}, error);
        if (!stage->truth) return false;
    }
    if (!image_init(&stage->image, stage->job.width_px, stage->job.height_px, stage->job.output.has_depth,
                    stage->job.output.has_transmittance, error) ||
        !render(stage, &stage->plan, frame_range_at(&stage->job.frames, segment.count - 1), &stage->image, &seconds,
                error))
        return false;
    for (int i = 0; i < FRAMES && i < segment.count; i++) {
        int64_t at = segment.count > FRAMES ? (2 * i + 1) * segment.count / (2 * FRAMES) : i;
        int32_t frame = frame_range_at(&stage->job.frames, at);

        struct plan plan = plan_of_frame(&stage->plan, &stage->job, frame);

        if (!render(stage, &plan, frame, &stage->image, &seconds, error) || !measure_error(stage, frame, &found, error))
            return false;
        stage->seconds += seconds;
        stage->square += found * found;
        stage->missed_count += !(found <= stage->job.quality.tolerance);
        stage->frame_count++;
        fprintf(stderr, "%s frame %d: error %.2e, %.3g s\n", stage->job.name, (int)frame, found, seconds);
    }
    return true;
}

static void print_row(const struct stage *stage, double plan_s)
{
    const struct plan *plan = &stage->plan;
    double predicted_s = stage->by_processor ? plan->predicted_processor_s : plan->predicted_s;
    double seconds = stage->seconds / stage->frame_count, error = sqrt(stage->square / stage->frame_count);

    printf("| `%s` | %s | %.3g | %.3g | %.2f | %.1e | %.1e | %.2f | %d of %d | %.1f |\n", stage->job.name,
           job_method_name(plan->quality.method), predicted_s, seconds, predicted_s / seconds, plan->predicted_error,
           error, plan->predicted_error / error, stage->missed_count, stage->frame_count, plan_s);
    fflush(stdout);
}

static bool predict(struct renderer *renderer, const char *path, int width_px, double tolerance, struct error *error)
{
    struct stage stage = {.renderer = renderer, .by_processor = renderer_is_software(renderer)};
    bool ok = load_job(&stage.job, path, width_px, tolerance, error);
    double plan_s = clock_read_s(stage.by_processor ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC);
    enum renderer_fault fault;

    ok = ok && plan_make(&stage.plan,
                         &(struct plan_params){.renderer = renderer,
                                               .job = &stage.job,
                                               .segment = plan_segment_at(&stage.job, 0),
                                               .is_timed = true,
                                               .evidence = &stage.evidence},
                         &fault, error);
    plan_s = clock_read_s(stage.by_processor ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC) - plan_s;
    ok = ok && measure(&stage, error);
    if (ok) print_row(&stage, plan_s);
    truth_close(stage.truth);
    plan_evidence_finish(&stage.evidence);
    image_finish(&stage.image);
    job_finish(&stage.job);
    return ok;
}

int main(int argc, char *argv[])
{
    int width_px = argc > 3 ? atoi(argv[1]) : 0, failures = 0;
    double tolerance = argc > 3 ? atof(argv[2]) : 0.0;
    struct error error = {0};
    struct gl_context *context = gl_context_create(GL_BACKEND_AUTO, NULL, &error);
    struct renderer *renderer = context ? renderer_create(context, NULL) : NULL;

    if (!context || width_px < 1 || !(tolerance > 0.0)) {
        fprintf(stderr, "%s\n", context ? "usage: predictions_bench WIDTH TOLERANCE JOB..." : error.message);
        gl_context_destroy(context);
        return 2;
    }
    printf(
        "| job | method | s predicted | measured | ratio | error predicted | measured | ratio | frames over | plan, s "
        "|\n");
    printf("|---|---|---|---|---|---|---|---|---|---|\n");
    for (int i = 3; i < argc; i++)
        if (!predict(renderer, argv[i], width_px, tolerance, &error)) {
            fprintf(stderr, "%s: %s\n", argv[i], error.message);
            failures = 1;
        }
    renderer_destroy(renderer);
    gl_context_destroy(context);
    return failures;
}
