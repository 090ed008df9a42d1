// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_shared.h"

#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/plan/plan.h"
#include "worker/plan/plan_evidence.h"
#include "worker/plan/plan_family.h"
#include "worker/plan/plan_lattice.h"
#include "worker/plan/plan_lookup.h"
#include "worker/plan/plan_params.h"
#include "worker/render/renderer.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static_assert((int)PLAN_JSON_REASON_SIZE == (int)PLAN_REASON_SIZE &&
                  (int)PLAN_JSON_SCOUT_LIMIT == (int)PLAN_SCOUT_LIMIT &&
                  (int)PLAN_JSON_VIEW_LIMIT == (int)PLAN_PILOT_LIMIT,
              "plans fit into messages");

// Must change whenever a change of the code makes other plans, or other pictures of the same plan.
static const char FORMAT[] = "marchd plan 10 of " MARCHD_VERSION;

void plan_shared_find_key(const struct plan_params *params, char key[static HASH_TEXT_SIZE])
{
    const struct plan_segment *segment = &params->segment;
    const struct job *job = params->job;
    char *bytes = NULL;
    size_t size_bytes = 0;
    FILE *text = open_memstream(&bytes, &size_bytes);

    if (!text) abort();
    fprintf(text, "%s\njob %s\n", FORMAT, job->hash);
    for (int64_t i = 0; i < segment->count; i++)
        fprintf(text, "%d ", (int)frame_range_at(&job->frames, segment->first + i));
    // A pilot leaves out frames whose files cannot be read.
    for (int i = 0; i < segment->pilot_count; i++) {
        char hash[HASH_TEXT_SIZE] = "";
        enum renderer_fault fault;

        (void)renderer_hash_picture(params->renderer, job, segment->pilot[i], hash, &fault, NULL);
        fprintf(text, "\nfiles %s", hash);
    }
    if (fclose(text) != 0) abort();
    hash_bytes(bytes, size_bytes, key);
    free(bytes);
}

void plan_shared_describe(struct plan_json *shared, const struct plan *plan, const struct plan_evidence *evidence,
                          const struct job *job)
{
    const struct audit_samples *samples = &evidence->pool.samples;
    const struct plan before = {.quality = plan->before, .pixels = plan->before.pixels};

    *shared = (struct plan_json){.quality = plan_apply(plan, job).quality,
                                 .has_before = plan->has_before,
                                 .before = plan_apply(&before, job).quality,
                                 .scout_count = plan->scouting.count,
                                 .cells_square = plan->cells_square,
                                 .paths_square = plan->paths_square,
                                 .view_quality = evidence->finest,
                                 .view_pixels = evidence->pixel_limit,
                                 .view_count = evidence->view_count,
                                 .sample_change = evidence->pool.change,
                                 .beyond = plan->beyond};
    memcpy(shared->reason, plan->reason, sizeof shared->reason);
    memcpy(shared->scout_errors, plan->scouting.error, sizeof shared->scout_errors);
    for (int i = 0; i < evidence->view_count; i++)
        shared->view_frames[i] = evidence->views[i].frame;
    for (size_t i = 0; i < samples->count && i < PLAN_JSON_SAMPLE_LIMIT; i++) {
        const struct audit_sample *sample = &samples->list[i];

        memcpy(shared->samples[i], (double[]){sample->square, sample->cross, sample->noise}, sizeof shared->samples[i]);
        shared->sample_count++;
    }
}

static bool render_view(struct plan_view *view, const struct plan_lattice *lattice, const struct plan_json *shared,
                        const struct plan_params *params, enum renderer_fault *fault, struct error *error)
{
    struct job finer = *params->job, coarser = *params->job;
    struct renderer_result result;

    finer.quality = shared->view_quality;
    coarser.quality = shared->quality;
    if (plan_lattice_render(lattice, params, &finer, view->frame, &view->finer, &result, error) &&
        plan_lattice_render(lattice, params, &coarser, view->frame, &view->coarser, &result, error))
        return true;
    *fault = result.fault;
    return false;
}

// A frame whose files can no longer be read has no view.
static bool render_views(struct plan_evidence *evidence, const struct plan_json *shared,
                         const struct plan_params *params, enum renderer_fault *fault, struct error *error)
{
    struct plan_lattice lattice;
    bool ok = true;

    plan_lattice_init(&lattice, params->job, shared->view_pixels);
    for (int i = 0; i < shared->view_count && ok; i++) {
        struct plan_view *view = &evidence->views[evidence->view_count++];

        *view = (struct plan_view){.frame = shared->view_frames[i]};
        if (render_view(view, &lattice, shared, params, fault, error)) continue;
        image_finish(&view->finer);
        image_finish(&view->coarser);
        evidence->view_count--;
        ok = *fault == RENDERER_FAULT_FRAME;
    }
    plan_lattice_finish(&lattice);
    return ok;
}

static void take_samples(struct audit_pool *pool, const struct plan_json *shared)
{
    audit_pool_finish(pool);
    pool->change = shared->sample_change;
    for (int i = 0; i < shared->sample_count; i++) {
        const double *numbers = shared->samples[i];

        audit_samples_append(&pool->samples, &(struct audit_sample){numbers[0], numbers[1], numbers[2]});
    }
}

bool plan_shared_adopt(struct plan *plan, struct plan_evidence *evidence, const struct plan_json *shared,
                       const struct plan_params *params, enum renderer_fault *fault, struct error *error)
{
    const struct plan_segment *segment = &params->segment;
    struct plan_scene scene;

    *fault = RENDERER_FAULT_NONE;
    plan_scene_init(&scene, params->job);
    *plan = (struct plan){.quality = shared->quality,
                          .pixels = shared->quality.pixels,
                          .has_before = shared->has_before,
                          .before = shared->before,
                          .cells_square = shared->cells_square,
                          .paths_square = shared->paths_square,
                          .beyond = shared->beyond};
    plan->quality.pixels = (struct job_pixels){0};
    if (!plan_lookup(&scene, &shared->quality, &plan->family, &plan->point)) {
        error_set(error, "expected settings that a plan of this version chooses");
        return false;
    }
    memcpy(plan->reason, shared->reason, sizeof plan->reason);
    plan->scouting.count = shared->scout_count;
    plan->scouting.first = segment->first;
    plan->scouting.last = segment->first + segment->count - 1;
    memcpy(plan->scouting.error, shared->scout_errors, sizeof plan->scouting.error);
    take_samples(&evidence->pool, shared);
    evidence->finest = shared->view_quality;
    evidence->pixel_limit = shared->view_pixels;
    return evidence->view_count > 0 || render_views(evidence, shared, params, fault, error);
}

static bool is_same_point(const struct plan *a, const struct plan *b)
{
    return a->family == b->family && memcmp(&a->point, &b->point, sizeof a->point) == 0;
}

// False where the plan that is refined so is another one in that frame.
static bool refine_all(struct plan *plan, int32_t frame, const struct plan *found, const struct job *job)
{
    struct plan first = plan_of_frame(plan, job, frame), of_frame;
    struct plan_scene scene;

    if (first.family != found->family) return false;
    for (int i = 0; i < PLAN_AXIS_LIMIT; i++) {
        plan->point.rungs[i] += found->point.rungs[i] - first.point.rungs[i];
        if (plan->point.rungs[i] < 0) return false;
    }
    plan_scene_init(&scene, job);
    plan->quality = plan_family_quality(&plan_families[plan->family], &scene, &plan->point);
    plan->pixels = found->pixels;
    of_frame = plan_of_frame(plan, job, frame);
    return is_same_point(&of_frame, found);
}

void plan_shared_replace(struct plan_json *shared, const struct plan *plan, int32_t frame, const struct plan *found,
                         const struct plan_evidence *evidence, const struct job *job)
{
    struct plan next = *plan;

    if (!refine_all(&next, frame, found, job)) {
        next = *found;
        next.scouting.count = 0;
    }
    next.has_before = found->has_before;
    next.before = found->before;
    next.beyond = plan->beyond;
    plan_shared_describe(shared, &next, evidence, job);
    memcpy(shared->reason, found->reason, sizeof shared->reason);
    // Of settings to which no frame returns.
    if (!found->has_before && !plan->has_before) shared->sample_count = 0;
}
