// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/liveness.h"

#include <inttypes.h>
#include <stdio.h>

enum {
    DEFAULT_START_MS = 30 * 1000,
    DEFAULT_HEARTBEAT_MS = 10 * 1000,
    DEFAULT_PROGRESS_MS = 120 * 1000,
    DEFAULT_RUN_MS = 60 * 1000,
    DEFAULT_RUN_FACTOR = 20,
    SLOW_FACTOR = 5,
    SLOW_LEAST_MS = 10 * 1000
};

static void apply_defaults(struct liveness_limits *limits)
{
    if (limits->start_ms <= 0) limits->start_ms = DEFAULT_START_MS;
    if (limits->heartbeat_ms <= 0) limits->heartbeat_ms = DEFAULT_HEARTBEAT_MS;
    if (limits->progress_ms <= 0) limits->progress_ms = DEFAULT_PROGRESS_MS;
    if (limits->run_ms <= 0) limits->run_ms = DEFAULT_RUN_MS;
    if (!(limits->run_factor > 0)) limits->run_factor = DEFAULT_RUN_FACTOR;
}

void liveness_start(struct liveness *liveness, int64_t now_ms)
{
    struct liveness_limits limits = liveness->limits;

    apply_defaults(&limits);
    *liveness = (struct liveness){.limits = limits,
                                  .started_ms = now_ms,
                                  .last_message_ms = now_ms,
                                  .last_progress_ms = now_ms,
                                  .checked_ms = now_ms};
}

void liveness_note_message(struct liveness *liveness, int64_t now_ms)
{
    liveness->last_message_ms = now_ms;
}

void liveness_ready(struct liveness *liveness, int64_t now_ms)
{
    liveness->last_message_ms = now_ms;
    liveness->is_ready = true;
}

void liveness_progress(struct liveness *liveness, double progress, int64_t now_ms)
{
    liveness->last_message_ms = now_ms;
    if (progress == liveness->progress) return;
    liveness->progress = progress;
    liveness->last_progress_ms = now_ms;
}

void liveness_begin_frame(struct liveness *liveness, int64_t now_ms)
{
    liveness->last_message_ms = now_ms;
    liveness->last_progress_ms = now_ms;
    liveness->rendering_ms = now_ms;
    liveness->rendered_ms = liveness->planned_ms = 0;
    liveness->is_rendering = true;
    liveness->is_planning = liveness->is_slow = false;
}

void liveness_begin_plan(struct liveness *liveness, int64_t now_ms)
{
    liveness->last_message_ms = now_ms;
    liveness->last_progress_ms = now_ms;
    if (!liveness->is_rendering) return;
    liveness->rendered_ms += now_ms - liveness->rendering_ms;
    liveness->rendering_ms = now_ms;
    liveness->is_rendering = false;
    liveness->is_planning = true;
}

void liveness_end_plan(struct liveness *liveness, int64_t now_ms)
{
    liveness->last_message_ms = now_ms;
    liveness->last_progress_ms = now_ms;
    if (!liveness->is_planning) return;
    liveness->planned_ms += now_ms - liveness->rendering_ms;
    liveness->rendering_ms = now_ms;
    liveness->is_rendering = true;
    liveness->is_planning = false;
}

void liveness_end_frame(struct liveness *liveness, int64_t now_ms)
{
    liveness->last_message_ms = now_ms;
    liveness->last_progress_ms = now_ms;
    liveness->is_rendering = liveness->is_planning = false;
}

void liveness_set_busy(struct liveness *liveness, bool is_busy, int64_t now_ms)
{
    if (is_busy && !liveness->is_busy) liveness->last_progress_ms = now_ms;
    liveness->is_busy = is_busy;
    // A dropped frame ends without a message of its own.
    if (!is_busy) liveness->is_rendering = liveness->is_planning = false;
}

// A call that comes more than half a heartbeat after the one before shows that the caller itself was delayed.
static void forgive_own_delay(struct liveness *liveness, int64_t now_ms)
{
    int64_t gap_ms = now_ms - liveness->checked_ms;
    int64_t *clocks[] = {&liveness->started_ms, &liveness->last_message_ms, &liveness->last_progress_ms,
                         &liveness->rendering_ms};

    liveness->checked_ms = now_ms;
    if (gap_ms <= liveness->limits.heartbeat_ms / 2) return;
    for (size_t i = 0; i < sizeof clocks / sizeof clocks[0]; i++) {
        *clocks[i] += gap_ms;
        if (*clocks[i] > now_ms) *clocks[i] = now_ms;
    }
}

static int64_t medians_ms(const struct liveness_job *job, double factor, int64_t least_ms)
{
    double limit_ms = factor * job->median_s * 1000;

    if (job->known < LIVENESS_KNOWN_FRAMES || limit_ms >= (double)INT64_MAX) return INT64_MAX;
    return limit_ms > (double)least_ms ? (int64_t)limit_ms : least_ms;
}

// Of the attempt that is being rendered or planned.
static enum liveness_verdict check_frame(struct liveness *liveness, const struct liveness_job *job, int64_t now_ms,
                                         char reason[static LIVENESS_REASON_SIZE])
{
    const struct liveness_limits *limits = &liveness->limits;
    int64_t part_ms = now_ms - liveness->rendering_ms;
    int64_t render_ms = liveness->rendered_ms + (liveness->is_rendering ? part_ms : 0);
    int64_t plan_ms = liveness->planned_ms + (liveness->is_planning ? part_ms : 0);
    int64_t limit_ms = job->stated_limit_ms > 0 ? job->stated_limit_ms : job->limit_ms;
    int64_t run_ms = job->stated_limit_ms > 0 ? INT64_MAX : medians_ms(job, limits->run_factor, limits->run_ms);

    if (limit_ms > 0 && render_ms > limit_ms) {
        snprintf(reason, LIVENESS_REASON_SIZE, "frame takes more than %.6g s (%s)", (double)limit_ms / 1000,
                 job->stated_limit_ms > 0 ? "the job's frame_limit" : "frame-limit");
        return LIVENESS_OVER_LIMIT;
    }
    if (job->limit_ms > 0 && plan_ms > job->limit_ms) {
        snprintf(reason, LIVENESS_REASON_SIZE, "frame is planned for more than %.6g s (frame-limit)",
                 (double)job->limit_ms / 1000);
        return LIVENESS_OVER_LIMIT;
    }
    if (liveness->is_rendering && part_ms > run_ms) {
        snprintf(reason, LIVENESS_REASON_SIZE, "frame renders for more than %" PRId64 " s, the job's median is %.3g s",
                 run_ms / 1000, job->median_s);
        return LIVENESS_OVERLONG;
    }
    if (liveness->is_slow || render_ms <= medians_ms(job, SLOW_FACTOR, SLOW_LEAST_MS)) return LIVENESS_ALIVE;
    liveness->is_slow = true;
    snprintf(reason, LIVENESS_REASON_SIZE, "frame takes more than %.3g s, the job's median is %.3g s",
             (double)render_ms / 1000, job->median_s);
    return LIVENESS_SLOW;
}

enum liveness_verdict liveness_check(struct liveness *liveness, const struct liveness_job *job, int64_t now_ms,
                                     char reason[static LIVENESS_REASON_SIZE])
{
    const struct liveness_limits *limits = &liveness->limits;

    forgive_own_delay(liveness, now_ms);
    if (!liveness->is_ready) {
        if (now_ms - liveness->started_ms <= limits->start_ms) return LIVENESS_ALIVE;
        snprintf(reason, LIVENESS_REASON_SIZE, "not ready %" PRId64 " s after its start", limits->start_ms / 1000);
        return LIVENESS_NO_START;
    }
    if (now_ms - liveness->last_message_ms > limits->heartbeat_ms) {
        snprintf(reason, LIVENESS_REASON_SIZE, "no message for %" PRId64 " s", limits->heartbeat_ms / 1000);
        return LIVENESS_SILENT;
    }
    if (liveness->is_busy && now_ms - liveness->last_progress_ms > limits->progress_ms) {
        snprintf(reason, LIVENESS_REASON_SIZE, "no progress for %" PRId64 " s", limits->progress_ms / 1000);
        return LIVENESS_STUCK;
    }
    if (!liveness->is_rendering && !liveness->is_planning) return LIVENESS_ALIVE;
    return check_frame(liveness, job, now_ms, reason);
}
