// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_shelf.h"

#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/audit/truth.h"
#include "worker/plan/plan_make.h"
#include "worker/plan/plan_shared.h"
#include "worker/plan/plan_source.h"

#include <inttypes.h>

// The plan is no longer the one whose evidence was kept.
static void drop_use(struct plan_kept *kept)
{
    truth_close(kept->truth);
    kept->truth = NULL;
    plan_evidence_finish(&kept->evidence);
    kept->number = 0;
}

static void drop_plan(struct plan_kept *kept)
{
    drop_use(kept);
    *kept = (struct plan_kept){0};
}

void plan_shelf_finish(struct plan_shelf *shelf)
{
    for (int i = 0; i < PLAN_SHELF_LIMIT; i++)
        drop_plan(&shelf->kept[i]);
}

static struct plan_kept *find_place(struct plan_shelf *shelf, const struct plan_shelf_params *params)
{
    struct plan_kept *oldest = &shelf->kept[0];

    for (int i = 0; i < PLAN_SHELF_LIMIT; i++) {
        struct plan_kept *kept = &shelf->kept[i];

        if (kept->serial == params->serial && kept->segment == params->plan.segment.index) return kept;
        if (kept->used < oldest->used) oldest = kept;
    }
    drop_plan(oldest);
    oldest->serial = params->serial;
    oldest->segment = params->plan.segment.index;
    plan_shared_find_key(&params->plan, oldest->key);
    return oldest;
}

static bool give_up(enum plan_source_answer answer, enum renderer_fault *fault, struct error *error)
{
    *fault = answer == PLAN_SOURCE_STOPPED ? RENDERER_FAULT_STOPPED : RENDERER_FAULT_FRAME;
    if (answer == PLAN_SOURCE_STOPPED) error_set(error, "the frame was stopped");
    return false;
}

// `missed` is the number of the plan that the newest one replaces; 0: none.
static bool number_newest(struct plan_shelf *shelf, const struct plan_shelf_params *params, struct plan_kept *kept,
                          int64_t missed, enum renderer_fault *fault, struct error *error)
{
    const struct plan_source *source = params->source;
    enum plan_source_answer answer;

    if (!source) {
        kept->newest_number = ++shelf->plan_count;
        return true;
    }
    answer = source->keep(source->user, kept->key, missed, &kept->newest, &kept->newest_number, error);
    return answer == PLAN_SOURCE_HAS || give_up(answer, fault, error);
}

static bool adopt(struct plan_kept *kept, const struct plan_shelf_params *params, enum renderer_fault *fault,
                  struct error *error)
{
    if (!plan_shared_adopt(&kept->plan, &kept->evidence, &kept->newest, &params->plan, fault, error)) return false;
    kept->number = kept->newest_number;
    return true;
}

static bool make(struct plan_shelf *shelf, const struct plan_shelf_params *params, struct plan_kept *kept,
                 enum renderer_fault *fault, struct error *error)
{
    struct plan_params plan_params = params->plan;

    drop_use(kept);
    if (params->on_plan) params->on_plan(params->user);
    plan_params.evidence = &kept->evidence;
    plan_params.truth = &kept->truth;
    if (!plan_make(&kept->plan, &plan_params, fault, error)) return false;
    if (params->on_planned) params->on_planned(params->user, kept->plan.predicted_s);
    plan_shared_describe(&kept->newest, &kept->plan, &kept->evidence, params->plan.job);
    if (!number_newest(shelf, params, kept, kept->newest_number, fault, error)) return false;
    if (adopt(kept, params, fault, error)) return true;
    if (*fault == RENDERER_FAULT_NONE) *fault = RENDERER_FAULT_JOB;
    return false;
}

static bool refresh(struct plan_shelf *shelf, const struct plan_shelf_params *params, struct plan_kept *kept,
                    enum renderer_fault *fault, struct error *error)
{
    const struct plan_source *source = params->source;
    enum plan_source_answer answer = kept->newest_number > 0 ? PLAN_SOURCE_HAS : PLAN_SOURCE_MAKE;
    struct error unusable = {0};

    if (source) answer = source->find(source->user, kept->key, &kept->newest_number, &kept->newest, error);
    if (answer == PLAN_SOURCE_MAKE) return make(shelf, params, kept, fault, error);
    if (answer != PLAN_SOURCE_HAS) return give_up(answer, fault, error);
    if (kept->number == kept->newest_number) return true;
    drop_use(kept);
    if (adopt(kept, params, fault, &unusable)) return true;
    if (*fault != RENDERER_FAULT_NONE) {
        if (error) *error = unusable;
        return false;
    }
    log_info("plan %" PRId64 " is made again: %s", kept->newest_number, unusable.message);
    return make(shelf, params, kept, fault, error);
}

struct plan_kept *plan_shelf_find(struct plan_shelf *shelf, const struct plan_shelf_params *params,
                                  enum renderer_fault *fault, struct error *error)
{
    struct plan_kept *kept = find_place(shelf, params);

    kept->used = ++shelf->use_count;
    if (refresh(shelf, params, kept, fault, error)) return kept;
    drop_plan(kept);
    return NULL;
}

bool plan_shelf_replace(struct plan_shelf *shelf, const struct plan_shelf_params *params, struct plan_kept *kept,
                        int32_t frame, const struct plan *found, enum renderer_fault *fault, struct error *error)
{
    plan_shared_replace(&kept->newest, &kept->plan, frame, found, &kept->evidence, params->plan.job);
    return number_newest(shelf, params, kept, kept->number, fault, error);
}
