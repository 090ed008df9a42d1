// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_slot.h"

#include "core/json/json_write.h"
#include "daemon/nodes/node.h"
#include "daemon/settings/pool_options.h"
#include "daemon/workers/worker_process.h"

#include <stdlib.h>

const char *const worker_slot_state_names[WORKER_SLOT_STATE_COUNT] = {"starting",    "idle",     "busy",
                                                                      "backing_off", "stopping", "waiting"};

void worker_slot_finish(struct worker_slot *slot)
{
    free(slot->reason);
    *slot = (struct worker_slot){0};
}

void worker_slot_set_reason(struct worker_slot *slot, char *reason)
{
    free(slot->reason);
    slot->reason = reason;
}

enum worker_slot_state worker_slot_state(const struct worker_slot *slot)
{
    if (!slot->worker && slot->node && node_state(slot->node) != NODE_READY) return WORKER_SLOT_WAITING;
    if (!slot->worker) return WORKER_SLOT_BACKING_OFF;
    if (slot->worker->state == WORKER_STARTING) return WORKER_SLOT_STARTING;
    if (slot->worker->state == WORKER_STOPPING) return WORKER_SLOT_STOPPING;
    return slot->worker->in_flight.count > 0 ? WORKER_SLOT_BUSY : WORKER_SLOT_IDLE;
}

static void write_process(const struct worker_process *worker, struct json_writer *writer)
{
    int64_t job = worker ? in_flight_current_job(&worker->in_flight) : 0;

    json_write_string_member(writer, "backend", worker ? worker->backend : NULL);
    json_write_string_member(writer, "vendor", worker ? worker->vendor : NULL);
    json_write_string_member(writer, "renderer", worker ? worker->renderer : NULL);
    json_write_string_member(writer, "version", worker ? worker->version : NULL);
    json_write_string_member(writer, "device_uuid", worker ? worker->device_uuid : NULL);
    json_write_string_member(writer, "sandbox", worker ? worker->sandbox : NULL);
    json_write_key(writer, "job");
    if (job)
        json_write_integer(writer, job);
    else
        json_write_null(writer);
    json_write_integer_member(writer, "frames", worker ? (int64_t)worker->in_flight.count : 0);
}

void worker_slot_write(const struct worker_slot *slot, int id, struct json_writer *writer)
{
    const char *reason = slot->node ? node_reason(slot->node) : NULL;

    json_write_begin_object(writer);
    json_write_integer_member(writer, "id", id);
    json_write_string_member(writer, "pool", slot->node ? node_pool(slot->node)->name : "local");
    json_write_string_member(writer, "node", slot->node ? node_name(slot->node) : NULL);
    json_write_key(writer, "pid");
    if (slot->worker)
        json_write_integer(writer, worker_process_pid(slot->worker));
    else
        json_write_null(writer);
    json_write_string_member(writer, "state", worker_slot_state_names[worker_slot_state(slot)]);
    write_process(slot->worker, writer);
    json_write_integer_member(writer, "done", slot->done + (slot->worker ? slot->worker->done : 0));
    json_write_string_member(writer, "reason", reason ? reason : slot->reason);
    json_write_end_object(writer);
}
