// Sends events to subscribers. A client that does not read its events is disconnected.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/in_flight.h"
#include "daemon/schedule/queue.h"

#include <stdbool.h>
#include <stdint.h>

struct client;
struct events;
struct farm;
struct job_record;

struct events *events_create(struct farm *farm);
void events_close(struct events *events);
void events_destroy(struct events *events); // after the loop closed its handles; accepts NULL

// `job` 0: all jobs. False when the client has too many subscriptions.
bool events_subscribe(struct events *events, struct client *client, int64_t job, bool wants_frames);
void events_unsubscribe(struct events *events, const struct client *client, int64_t job); // as events_subscribe has it
void events_forget(struct events *events, const struct client *client);                   // removes its subscriptions

// Sends a change of state at once, and changed counts at most every 250 ms.
void events_note_job(struct events *events, struct job_record *record);
void events_note_reasons(struct events *events); // those of all live jobs changed: the store's trouble, a drain
void events_send_deleted(struct events *events, struct job_record *record); // its last event
void events_send_frame(struct events *events, const struct queue_ticket *ticket, enum frame_state state,
                       const char *error);                                          // NULL: none
void events_send_phase(struct events *events, const struct in_flight_frame *frame); // of a running frame
void events_send_worker(struct events *events, int slot_index);
