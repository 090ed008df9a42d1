// What becomes of a frame after a worker answered for it, died with it, or its file was published.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;
struct publish_request;
struct worker_process;
struct worker_report;

// `report` is about a frame.
void frame_life_note_report(struct farm *farm, struct worker_process *worker, const struct worker_report *report);
// The worker is gone: what it held is tried again, or failed when it had its attempts.
void frame_life_lose_frames(struct farm *farm, struct worker_process *worker, const char *reason);
void frame_life_on_published(void *user, const struct publish_request *request); // the publisher's; `user` is the farm
