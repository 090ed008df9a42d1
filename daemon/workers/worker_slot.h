// One worker slot: its worker, or why it has none.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/retry.h"
#include "daemon/schedule/turns.h"

#include <stdbool.h>
#include <stdint.h>

struct json_writer;
struct node;
struct worker_process;

enum worker_slot_state {
    WORKER_SLOT_STARTING,
    WORKER_SLOT_IDLE,
    WORKER_SLOT_BUSY,
    WORKER_SLOT_BACKING_OFF,
    WORKER_SLOT_STOPPING,
    WORKER_SLOT_WAITING, // for its node
    WORKER_SLOT_STATE_COUNT
};

extern const char *const worker_slot_state_names[WORKER_SLOT_STATE_COUNT];

// The zero value is empty.
struct worker_slot {
    struct node *node;             // borrowed; where its workers run; NULL: on this machine
    struct worker_process *worker; // NULL: none
    struct retry_backoff backoff;
    char *reason; // owned; why the latest worker ended or did not start; NULL: no fault
    int64_t done; // count of frames by earlier workers
    struct turns_seat seat;
    uint64_t changing_ns; // monotonic; when its worker was told to make room; 0: it was not
    bool is_short;        // frames were not given to it for its machine goes before they would be done
    uint64_t charged_ns;  // monotonic; up to when the owner is charged
};

void worker_slot_finish(struct worker_slot *slot);                   // legal when no worker runs
void worker_slot_set_reason(struct worker_slot *slot, char *reason); // takes ownership; NULL: none
enum worker_slot_state worker_slot_state(const struct worker_slot *slot);
// The object *worker* of docs/protocol.md.
void worker_slot_write(const struct worker_slot *slot, int id, struct json_writer *writer);
