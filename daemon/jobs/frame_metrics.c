// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/frame_metrics.h"

#include "core/wire/worker_status.h"
#include "daemon/farm/farm.h"
#include "daemon/metrics/metrics.h"
#include "daemon/output/publisher.h"
#include "daemon/workers/worker_pool.h"

static int pool_of(const struct farm *farm, int worker)
{
    return worker_pool_seat(farm->pool, worker - 1)->kind;
}

void frame_metrics_note_start(struct farm *farm, const struct job_record *record)
{
    int64_t since_ms = record->served_ms > record->submitted_ms ? record->served_ms : record->submitted_ms;

    histogram_add(&farm->metrics->start_wait_s, &histogram_wait_s, (double)(record->started_ms - since_ms) / 1000);
}

void frame_metrics_note_plan(struct farm *farm, const struct worker_process *worker, double seconds)
{
    histogram_add(&farm->metrics->plan_s[pool_of(farm, worker->id)], &histogram_work_s, seconds);
}

void frame_metrics_note_frame(struct farm *farm, const struct worker_process *worker,
                              const struct worker_report *report, const struct job_record *record)
{
    const struct frame_accuracy *accuracy = &report->accuracy;
    const struct job_facts *facts = &record->facts;
    bool is_measured = accuracy->audit[0] && facts->tolerance > 0;
    const struct metrics_source source = {.pool = pool_of(farm, worker->id),
                                          .backend = worker->backend,
                                          .method =
                                              accuracy->method[0] ? accuracy->method : job_method_name(facts->method)};

    farm->metrics->render_s += report->render_s;
    farm->metrics->encode_s += report->encode_s;
    farm->metrics->audit_s += report->audit_s;
    metrics_note_frame(farm->metrics, &source, report->render_s + report->encode_s + report->audit_s,
                       is_measured ? accuracy->error / facts->tolerance : -1);
}

void frame_metrics_note_published(struct farm *farm, const struct publish_request *request)
{
    struct metrics *metrics = farm->metrics;

    metrics->missed += frame_accuracy_is_over(&request->accuracy, request->record->facts.tolerance);
    if (request->is_found) {
        metrics->skipped++;
        return;
    }
    metrics->published++;
    metrics->published_bytes += (double)request->file.size_bytes;
    if (request->reported_ns > 0)
        histogram_add(&metrics->publish_s, &histogram_latency_s, (double)(uv_hrtime() - request->reported_ns) / 1e9);
}

void frame_metrics_note_fault(struct farm *farm, int worker, enum retry_fault fault)
{
    farm->metrics->faults[pool_of(farm, worker)][fault]++;
}

static enum metrics_end find_end(const struct worker_process *worker)
{
    if (worker->is_node_lost) return METRICS_END_NODE;
    if (worker->is_replaced && worker->in_flight.count == 0 && worker->exit_signal == 0) return METRICS_END_REPLACED;
    if (worker->suspect_code || worker->is_over_limit) return METRICS_END_OVER_LIMIT;
    if (worker->exit_status == WORKER_STATUS_MEMORY) return METRICS_END_MEMORY;
    if (!worker->backend) return METRICS_END_NO_START;
    if (worker->state == WORKER_STOPPING) return worker->exit_signal ? METRICS_END_KILLED : METRICS_END_STOPPED;
    return METRICS_END_DIED;
}

void frame_metrics_note_end(struct farm *farm, const struct worker_process *worker)
{
    farm->metrics->worker_ends[pool_of(farm, worker->id)][find_end(worker)]++;
}
