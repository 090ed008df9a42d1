// What follows for a frame after a report of its worker, the end of its worker, or the publishing of its file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;
struct publish_request;
struct worker_process;
struct worker_report;

// `report` must be about a frame.
void frame_life_note_report(struct farm *farm, struct worker_process *worker, const struct worker_report *report);
// The worker is gone: its frames are queued again, or failed when they have no attempts left.
void frame_life_lose_frames(struct farm *farm, struct worker_process *worker, const char *reason);
// Callback of the publisher; `user` is the farm.
void frame_life_on_published(void *user, const struct publish_request *request);
