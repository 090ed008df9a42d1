// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/after_look.h"

#include "core/base/alloc.h"
#include "daemon/farm/farm.h"

#include <stdlib.h>

// What those that a job comes after are like.
struct after_look {
    size_t open_count;                     // of those that are not over
    const struct job_record *open;         // the first of them
    const struct job_record *unsuccessful; // the first that is over and did not succeed
    int64_t gone;                          // the first that was deleted; 0: none
};

// A job is over once its last frames have left the workers.
static bool is_over(const struct job_record *record)
{
    return !queue_job_is_live(record->queued) && record->is_ending && !record->is_retry_waiting;
}

static struct after_look look(const struct farm *farm, const struct job_record *record)
{
    struct after_look look = {0};

    for (size_t i = 0; i < record->after.count; i++) {
        const struct job_record *first = job_table_find(&farm->jobs, record->after.ids[i]);

        if (!first) {
            if (look.gone == 0) look.gone = record->after.ids[i];
        } else if (!is_over(first)) {
            if (look.open_count++ == 0) look.open = first;
        } else if (queue_job_state(first->queued) != JOB_SUCCEEDED && !look.unsuccessful) {
            look.unsuccessful = first;
        }
    }
    return look;
}

enum queue_wait after_look_find_wait(const struct farm *farm, const struct job_record *record)
{
    const struct after_look found = look(farm, record);

    if (!record->after.takes_any_end && (found.gone || found.unsuccessful)) return QUEUE_WAITS_IN_VAIN;
    return found.open_count > 0 ? QUEUE_WAITS : QUEUE_WAITS_NOT;
}

static char *format_vain(const struct after_look *found, const struct job_record *record)
{
    if (found->gone)
        return xasprintf("paused: job %lld, which it comes after, was deleted: march resume %lld renders it all the "
                         "same",
                         (long long)found->gone, (long long)record->id);
    return xasprintf("paused: job %lld (\"%s\"), which it comes after, %s: march retry %lld, or march resume %lld to "
                     "render it all the same",
                     (long long)found->unsuccessful->id, found->unsuccessful->name,
                     queue_job_state(found->unsuccessful->queued) == JOB_CANCELED ? "was canceled" : "failed",
                     (long long)found->unsuccessful->id, (long long)record->id);
}

char *after_look_format_reason(const struct farm *farm, const struct job_record *record)
{
    const struct after_look found = look(farm, record);
    const struct frame_states *states;
    char *more, *text;
    int64_t done;

    if (!record->after.takes_any_end && (found.gone || found.unsuccessful)) return format_vain(&found, record);
    if (!found.open) return xstrdup("waits no more: it goes on in a moment");
    states = &found.open->queued->states;
    done = states->counts[FRAME_SUCCEEDED] + states->counts[FRAME_SKIPPED];
    more = found.open_count > 1 ? xasprintf(", and for %zu more", found.open_count - 1) : xstrdup("");
    text = xasprintf("waits for job %lld (\"%s\"): %lld of its %lld frames are done%s", (long long)found.open->id,
                     found.open->name, (long long)done, (long long)states->frame_count, more);
    free(more);
    return text;
}
