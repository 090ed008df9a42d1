// One place for a worker: who runs in it, or why nobody does.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/retry.h"

#include <stdint.h>

struct json_writer;
struct worker_process;

// The zero value is empty.
struct worker_slot {
    struct worker_process *worker; // NULL: none runs
    struct retry_backoff backoff;
    char *reason; // owned; why the worker before could not work; NULL: it could
    int64_t done; // frames, by the workers before
};

void worker_slot_finish(struct worker_slot *slot);                   // once no worker runs
void worker_slot_set_reason(struct worker_slot *slot, char *reason); // takes it over; NULL: none
// The object *worker* of docs/protocol.md.
void worker_slot_write(const struct worker_slot *slot, int id, struct json_writer *writer);
