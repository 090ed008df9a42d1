// Counts what happens to frames, jobs and workers, for whoever watches the farm.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/retry.h"

struct farm;
struct job_record;
struct publish_request;
struct worker_process;
struct worker_report;

// The first frame of the job is taken since it was submitted, or since it was over and retried.
void frame_metrics_note_start(struct farm *farm, const struct job_record *record);
void frame_metrics_note_plan(struct farm *farm, const struct worker_process *worker, double seconds);
// The frame was rendered, and is about to be published.
void frame_metrics_note_frame(struct farm *farm, const struct worker_process *worker,
                              const struct worker_report *report, const struct job_record *record);
void frame_metrics_note_published(struct farm *farm, const struct publish_request *request); // also of a found file
// An attempt that had begun ended; `worker` is the id of the worker that had it.
void frame_metrics_note_fault(struct farm *farm, int worker, enum retry_fault fault);
void frame_metrics_note_end(struct farm *farm, const struct worker_process *worker); // the process is gone
