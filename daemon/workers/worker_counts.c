// SPDX-License-Identifier: Apache-2.0
#include "daemon/workers/worker_counts.h"

#include "core/base/alloc.h"
#include "daemon/farm/job_table.h"
#include "daemon/workers/worker_nodes.h"
#include "daemon/workers/worker_process.h"

#include <string.h>

static bool is_ready(const struct worker_slot *slot)
{
    return slot->worker && slot->worker->state == WORKER_READY;
}

void worker_counts_find_ready(const struct worker_slot *slots, int slot_count, int ready[static TURNS_KIND_LIMIT])
{
    memset(ready, 0, TURNS_KIND_LIMIT * sizeof ready[0]);
    for (int i = 0; i < slot_count; i++)
        ready[slots[i].seat.kind] += is_ready(&slots[i]);
}

struct worker_counts worker_counts_of(const struct worker_slot *slots, int slot_count)
{
    struct worker_counts counts = {0};

    for (int i = 0; i < slot_count; i++)
        counts.slots[slots[i].seat.kind][worker_slot_state(&slots[i])]++;
    return counts;
}

// The slots of a node follow one another.
void worker_counts_find_nodes(const struct worker_slot *slots, int slot_count, int *up, int *waiting)
{
    *up = *waiting = 0;
    for (int i = 0; i < slot_count; i++) {
        if (!slots[i].node || (i > 0 && slots[i - 1].node == slots[i].node)) continue;
        *(worker_nodes_are_ready(&slots[i]) ? up : waiting) += 1;
    }
}

int worker_counts_find_usable(const struct worker_slot *slots, int slot_count, uint64_t barred, int64_t now_ms)
{
    int count = 0;

    for (int i = 0; i < slot_count; i++) {
        if (barred >> slots[i].seat.kind & 1) continue;
        count += slots[i].worker ||
                 (worker_nodes_are_ready(&slots[i]) && retry_backoff_wait_ms(&slots[i].backoff, now_ms) == 0);
    }
    return count;
}

char *worker_counts_format_trouble(const struct worker_slot *slots, int slot_count, const struct job_record *record)
{
    const char *reason = NULL, *pool = record ? record->pool : NULL;

    for (int i = 0; i < slot_count; i++) {
        if (record && !turns_may_serve(&slots[i].seat, &record->queued->turn)) continue;
        if (is_ready(&slots[i])) return NULL;
        if (!reason) reason = worker_nodes_are_ready(&slots[i]) ? slots[i].reason : node_reason(slots[i].node);
    }
    if (reason) return xasprintf("no worker%s%s is ready: %s", pool ? " of pool " : "", pool ? pool : "", reason);
    return xasprintf("waits for a worker%s%s that is being started", pool ? " of pool " : "", pool ? pool : "");
}
