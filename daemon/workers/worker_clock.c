// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_clock.h"

#include "core/base/log.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"
#include "daemon/workers/worker_process.h"

void worker_clock_check(struct farm *farm, struct worker_process *worker, int64_t now_ms)
{
    struct job_record *record = job_table_find(&farm->jobs, in_flight_current_job(&worker->in_flight));
    struct liveness_job job = {.limit_ms = farm->options->frame_limit_ms};
    char reason[LIVENESS_REASON_SIZE];
    struct log_subject subject = worker_process_subject(worker);
    enum liveness_verdict verdict;

    if (record) {
        job.median_s = estimate_median_s(&record->estimate);
        job.known = estimate_count(&record->estimate);
        job.stated_limit_ms = record->facts.frame_limit_ms;
    }
    verdict = liveness_check(&worker->liveness, &job, now_ms, reason);
    if (verdict == LIVENESS_ALIVE || worker->end_reason) return;
    if (verdict == LIVENESS_SLOW) {
        log_about(LOG_WARN, &subject, "job %lld frame %d: %s", (long long)subject.job, (int)subject.frame, reason);
        return;
    }
    worker->is_over_limit = verdict == LIVENESS_OVER_LIMIT;
    if (record && verdict >= LIVENESS_STUCK) worker->suspect_code = record->code;
    log_about(LOG_WARN, &subject, "worker %d: killed: %s", worker->id, reason);
    worker_process_kill(worker, reason);
}
