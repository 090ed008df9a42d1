// Assigns frames to the workers that can take some.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct farm;
struct job_record;
struct worker_process;

// Does nothing while the farm is drained or its store cannot commit. False when a worker still waits because the search
// for the next frame of a job takes long: call again.
bool feed_workers(struct farm *farm);
void feed_recall_all(struct farm *farm); // all workers give back the frames that they have not begun
// The worker renders a frame of the job: if it got others at the pace at which frames were skipped, or shorter ones
// rendered, it gives back those that it has not begun.
void feed_note_rendering(struct worker_process *worker, struct job_record *record);
