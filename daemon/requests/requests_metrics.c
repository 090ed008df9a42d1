// SPDX-License-Identifier: Apache-2.0
#include "daemon/requests/requests.h"

#include "core/base/alloc.h"
#include "core/json/json_write.h"
#include "daemon/clients/answer.h"
#include "daemon/farm/farm.h"
#include "daemon/farm/pool_access.h"
#include "daemon/jobs/job_wait.h"
#include "daemon/loop/loop_turns.h"
#include "daemon/metrics/metrics.h"
#include "daemon/metrics/metrics_write.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/workers/worker_pool.h"

#include <stdlib.h>
#include <sys/resource.h>

enum { JOBS_OF_A_STEP = 2000 }; // half a millisecond or so

// What jobs add up to.
struct job_sums {
    int64_t jobs[JOB_STATE_COUNT];
    int64_t waiting_jobs[JOB_WAIT_COUNT], waiting_frames[JOB_WAIT_COUNT];
    double longest_wait_s[JOB_WAIT_COUNT];
};

// An answer that looks at the jobs a few thousand at a step.
struct metrics_task {
    struct loop_task task;
    const struct farm *farm; // borrowed; outlives us
    struct answer *answer;   // owned
    int64_t next_id;         // of jobs that are not looked at yet
    struct job_sums sums;
};

static void add_job(struct job_sums *sums, const struct job_wait_scene *scene, const struct job_record *record,
                    int64_t clock_ms)
{
    enum job_wait wait = job_wait_find(scene, record);
    double wait_s = job_wait_seconds(scene, record, clock_ms);

    sums->jobs[queue_job_state(record->queued)]++;
    if (wait == JOB_WAIT_NONE) return;
    sums->waiting_jobs[wait]++;
    sums->waiting_frames[wait] += record->queued->states.counts[FRAME_QUEUED];
    if (wait_s > sums->longest_wait_s[wait]) sums->longest_wait_s[wait] = wait_s;
}

static void write_process(const struct farm *farm, struct json_writer *writer)
{
    struct rusage usage = {0};

    getrusage(RUSAGE_SELF, &usage);
    metrics_write_begin(writer, "gauge", "marchd_build_info", "The version that runs, as a label; always 1.");
    metrics_write_value(writer, (const char *[]){"version", MARCHD_VERSION, NULL}, 1);
    metrics_write_end(writer);
    metrics_write_single(writer, "gauge", "marchd_start_time_seconds", "When the daemon started, in unix time.",
                         (double)farm->started_ms / 1000);
    metrics_write_single(writer, "counter", "marchd_cpu_seconds_total",
                         "Processor time of the daemon itself, all threads, without its workers.",
                         (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                             (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) / 1e6);
    metrics_write_single(writer, "gauge", "marchd_memory_peak_bytes", "The most memory that the daemon itself has had.",
                         (double)usage.ru_maxrss * 1024);
}

static void write_turns(const struct farm *farm, struct json_writer *writer)
{
    const struct turn_counts *turns = loop_turns_counts(farm->turns);
    double ends[TURN_CLASS_COUNT - 1];

    for (int i = 0; i < TURN_CLASS_COUNT - 1; i++)
        ends[i] = (double)turn_class_ms[i] / 1000;
    metrics_write_begin(writer, "histogram", "marchd_loop_turn_seconds",
                        "Processor time of each turn of the daemon's loop.");
    metrics_write_classes(writer, NULL, ends, turns->counts, TURN_CLASS_COUNT - 1, (double)turns->sum_ns / 1e9);
    metrics_write_end(writer);
}

static void write_states(const struct farm *farm, const struct job_sums *sums, struct json_writer *writer)
{
    metrics_write_begin(writer, "gauge", "marchd_jobs", "Jobs that the daemon knows, by state.");
    for (int i = 0; i < JOB_STATE_COUNT; i++)
        metrics_write_value(writer, (const char *[]){"state", job_state_name((enum job_state)i), NULL},
                            (double)sums->jobs[i]);
    metrics_write_end(writer);
    metrics_write_begin(writer, "gauge", "marchd_frames", "Frames of jobs that the daemon knows, by state.");
    for (int i = 0; i < FRAME_STATE_COUNT; i++)
        metrics_write_value(writer, (const char *[]){"state", frame_state_name((enum frame_state)i), NULL},
                            (double)queue_count(farm->queue, (enum frame_state)i));
    metrics_write_end(writer);
}

static const char *const *reason_labels(const char *labels[static 3], int wait)
{
    labels[0] = "reason";
    labels[1] = job_wait_names[wait];
    labels[2] = NULL;
    return labels;
}

static void write_queue(const struct farm *farm, const struct job_sums *sums, struct json_writer *writer)
{
    const char *labels[3];

    metrics_write_begin(writer, "gauge", "marchd_queue_jobs", "Jobs with queued frames, by why these wait.");
    for (int i = JOB_WAIT_NONE + 1; i < JOB_WAIT_COUNT; i++)
        metrics_write_value(writer, reason_labels(labels, i), (double)sums->waiting_jobs[i]);
    metrics_write_end(writer);
    metrics_write_begin(writer, "gauge", "marchd_queue_frames", "Queued frames, by why they wait.");
    for (int i = JOB_WAIT_NONE + 1; i < JOB_WAIT_COUNT; i++)
        metrics_write_value(writer, reason_labels(labels, i), (double)sums->waiting_frames[i]);
    metrics_write_end(writer);
    metrics_write_begin(writer, "gauge", "marchd_queue_longest_wait_seconds",
                        "The longest time for which a job with queued frames has had none of them rendered.");
    for (int i = JOB_WAIT_NONE + 1; i < JOB_WAIT_COUNT; i++)
        metrics_write_value(writer, reason_labels(labels, i), sums->longest_wait_s[i]);
    metrics_write_end(writer);
    metrics_write_begin(writer, "histogram", "marchd_job_start_wait_seconds",
                        "From a job's submission, or its retry when it was over, to its first frame.");
    metrics_write_histogram(writer, NULL, &farm->metrics->start_wait_s, &histogram_wait_s);
    metrics_write_end(writer);
}

// Seats of this kind belong to this pool; NULL: there is none.
static const char *pool_name(const struct farm *farm, int kind)
{
    const struct pool_table *pools = &farm->options->pools;

    if (!(pool_access_all(farm) >> kind & 1)) return NULL;
    return kind == 0 ? POOL_LOCAL : pools->pools[kind - 1].name;
}

static void write_series(const struct farm *farm, struct json_writer *writer, bool is_error)
{
    const struct metrics *metrics = farm->metrics;

    for (size_t i = 0; i <= METRICS_SERIES_LIMIT; i++) {
        const struct metrics_frame_series *series = &metrics->frames[i];
        bool is_shared = i == METRICS_SERIES_LIMIT;
        const char *pool = is_shared ? "other" : pool_name(farm, series->pool);
        const char *backend = is_shared ? "other" : metrics_backend_name(series->backend);
        const char *method = is_shared ? "other" : metrics_method_name(series->method);
        const char *labels[] = {"pool", pool, "backend", backend, "method", method, NULL};

        if (i >= metrics->frame_count && !(is_shared && metrics->frame_count == METRICS_SERIES_LIMIT)) continue;
        if (is_error)
            metrics_write_histogram(writer, labels, &series->error, &histogram_ratio);
        else
            metrics_write_histogram(writer, labels, &series->seconds, &histogram_work_s);
    }
}

static void write_frames(const struct farm *farm, struct json_writer *writer)
{
    const struct metrics *metrics = farm->metrics;

    metrics_write_begin(writer, "histogram", "marchd_frame_seconds",
                        "Time of a worker for a frame: rendering, its audit and its file.");
    write_series(farm, writer, false);
    metrics_write_end(writer);
    metrics_write_begin(writer, "histogram", "marchd_frame_error_ratio",
                        "Measured error of a frame, relative to the tolerance of its job.");
    write_series(farm, writer, true);
    metrics_write_end(writer);
    metrics_write_begin(writer, "counter", "marchd_work_seconds_total",
                        "Time of workers for frames, by what they did.");
    metrics_write_value(writer, (const char *[]){"part", "render", NULL}, metrics->render_s);
    metrics_write_value(writer, (const char *[]){"part", "audit", NULL}, metrics->audit_s);
    metrics_write_value(writer, (const char *[]){"part", "encode", NULL}, metrics->encode_s);
    metrics_write_end(writer);
    metrics_write_single(writer, "counter", "marchd_frames_published_total", "Frames that were rendered and published.",
                         (double)metrics->published);
    metrics_write_single(writer, "counter", "marchd_frames_skipped_total", "Frames whose files were found to be there.",
                         (double)metrics->skipped);
    metrics_write_single(writer, "counter", "marchd_frames_missed_total",
                         "Frames that are over the tolerance of their job, published or found.",
                         (double)metrics->missed);
    metrics_write_single(writer, "counter", "marchd_published_bytes_total", "Bytes of published files.",
                         metrics->published_bytes);
}

static void write_disk(const struct farm *farm, struct json_writer *writer)
{
    const struct committer *committer = farm->committer;

    metrics_write_begin(writer, "histogram", "marchd_publish_seconds",
                        "From a worker's report of a frame to its file under its name, on disk.");
    metrics_write_histogram(writer, NULL, &farm->metrics->publish_s, &histogram_latency_s);
    metrics_write_end(writer);
    metrics_write_begin(writer, "histogram", "marchd_commit_seconds",
                        "From a change of the queue to its being on disk, of the oldest change of each commit.");
    metrics_write_histogram(writer, NULL, committer_seconds(committer), &histogram_latency_s);
    metrics_write_end(writer);
    metrics_write_single(writer, "gauge", "marchd_store_ok", "1: the store commits; 0: its disk is full, or it fails.",
                         !committer_trouble(committer));
    metrics_write_single(writer, "gauge", "marchd_store_waiting_changes", "Changes that are not on disk yet.",
                         (double)committer_waiting(committer));
    metrics_write_begin(writer, "gauge", "marchd_output_roots", "Output roots of settings and jobs.");
    for (int is_there = 1; is_there >= 0; is_there--) {
        int count = 0;

        for (size_t i = 0; i < farm->roots.count; i++)
            count += farm->roots.roots[i]->is_watched && farm->roots.roots[i]->is_there == is_there;
        metrics_write_value(writer, (const char *[]){"state", is_there ? "there" : "away", NULL}, count);
    }
    metrics_write_end(writer);
}

static void write_plans(const struct farm *farm, struct json_writer *writer)
{
    metrics_write_begin(writer, "histogram", "marchd_plan_seconds", "Time of a worker for a plan.");
    for (int kind = 0; kind < TURNS_KIND_LIMIT; kind++) {
        const char *pool = pool_name(farm, kind);

        if (pool)
            metrics_write_histogram(writer, (const char *[]){"pool", pool, NULL}, &farm->metrics->plan_s[kind],
                                    &histogram_work_s);
    }
    metrics_write_end(writer);
}

static void write_counters(const struct farm *farm, struct json_writer *writer, const char *label,
                           const char *const names[], int count, const uint64_t *counters)
{
    for (int kind = 0; kind < TURNS_KIND_LIMIT; kind++) {
        const char *pool = pool_name(farm, kind);

        for (int i = 0; pool && i < count; i++)
            metrics_write_value(writer, (const char *[]){"pool", pool, label, names[i], NULL},
                                (double)counters[kind * count + i]);
    }
}

static void write_slots(const struct farm *farm, struct json_writer *writer)
{
    struct worker_counts counts = worker_pool_count_slots(farm->pool);

    for (int kind = 0; kind < TURNS_KIND_LIMIT; kind++) {
        const char *pool = pool_name(farm, kind);

        for (int i = 0; pool && i < WORKER_SLOT_STATE_COUNT; i++)
            metrics_write_value(writer, (const char *[]){"pool", pool, "state", worker_slot_state_names[i], NULL},
                                counts.slots[kind][i]);
    }
}

static void write_workers(const struct farm *farm, struct json_writer *writer)
{
    int up, waiting;

    worker_pool_count_nodes(farm->pool, &up, &waiting);
    metrics_write_begin(writer, "gauge", "marchd_workers", "Workers by pool and state.");
    write_slots(farm, writer);
    metrics_write_end(writer);
    metrics_write_begin(writer, "gauge", "marchd_nodes", "Other machines of the pools.");
    metrics_write_value(writer, (const char *[]){"state", "up", NULL}, up);
    metrics_write_value(writer, (const char *[]){"state", "waiting", NULL}, waiting);
    metrics_write_end(writer);
    metrics_write_begin(writer, "counter", "marchd_worker_ends_total", "Worker processes that ended, by cause.");
    write_counters(farm, writer, "cause", metrics_end_names, METRICS_END_COUNT, farm->metrics->worker_ends[0]);
    metrics_write_end(writer);
    metrics_write_begin(writer, "counter", "marchd_frame_faults_total", "Attempts at frames that failed, by class.");
    write_counters(farm, writer, "fault", retry_fault_names, METRICS_FAULT_COUNT, farm->metrics->faults[0]);
    metrics_write_end(writer);
    metrics_write_single(writer, "gauge", "marchd_drained", "1: the farm is drained and begins no frame.",
                         farm->drain.user != NULL);
}

static void answer_task(struct metrics_task *task)
{
    const struct farm *farm = task->farm;
    struct json_writer value = {0};

    json_write_begin_object(&value);
    json_write_key(&value, "families");
    json_write_begin_array(&value);
    write_process(farm, &value);
    write_turns(farm, &value);
    write_states(farm, &task->sums, &value);
    write_queue(farm, &task->sums, &value);
    write_frames(farm, &value);
    write_plans(farm, &value);
    write_disk(farm, &value);
    write_workers(farm, &value);
    json_write_end_array(&value);
    json_write_end_object(&value);
    answer_send_result(task->answer, &value);
    json_writer_finish(&value);
}

static bool on_step(struct loop_task *loop_task)
{
    struct metrics_task *task = (struct metrics_task *)loop_task;
    const struct job_table *jobs = &task->farm->jobs;
    struct job_wait_scene scene = job_wait_look(task->farm);
    int64_t clock_ms = farm_clock_ms();
    size_t i = job_table_first_from(jobs, task->next_id);

    for (int count = 0; count < JOBS_OF_A_STEP && i < jobs->count; count++)
        add_job(&task->sums, &scene, jobs->records[i++], clock_ms);
    if (i < jobs->count) {
        task->next_id = jobs->records[i]->id;
        return true;
    }
    answer_task(task);
    free(task);
    return false;
}

enum request_outcome requests_daemon_metrics(struct request *request)
{
    struct metrics_task *task = xcalloc(1, sizeof *task);

    task->task.step = on_step;
    task->farm = request->farm;
    task->answer = request_defer_answer(request, true);
    loop_turns_put(request->farm->turns, &task->task);
    return REQUEST_DEFERRED;
}
