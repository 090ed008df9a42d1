// What follows when a worker asks for the plan of its frame's segment, made one, or leaves the frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct farm;
struct in_flight_frame;
struct job_record;
struct queue_ticket;
struct worker_report;

// `report` is plan.ask or plan.made about the record's frame.
void plan_life_note_report(struct farm *farm, const struct worker_report *report, struct job_record *record,
                           struct in_flight_frame *frame);
// The attempt is over. The next one that waits makes the plan that this one was to make.
void plan_life_leave(struct farm *farm, const struct queue_ticket *ticket);
