// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/late_sweep.h"

#include "core/base/alloc.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/root_life.h"

#include <stdlib.h>

enum { MARGIN_MS = 1000 };

struct late_sweep {
    struct late_sweep *next;
    int64_t job, due_ms; // monotonic
};

void late_sweep_note(struct farm *farm, int64_t job, int64_t heartbeat_ms)
{
    struct late_sweep *sweep = farm->late_sweeps;

    while (sweep && sweep->job != job)
        sweep = sweep->next;
    if (!sweep) {
        sweep = xcalloc(1, sizeof *sweep);
        *sweep = (struct late_sweep){.next = farm->late_sweeps, .job = job};
        farm->late_sweeps = sweep;
    }
    sweep->due_ms = farm_now_ms(farm) + heartbeat_ms + MARGIN_MS;
}

void late_sweep_run(struct farm *farm)
{
    struct late_sweep **link = &farm->late_sweeps, *sweep;

    while ((sweep = *link)) {
        struct job_record *record = job_table_find(&farm->jobs, sweep->job);

        if (farm_now_ms(farm) < sweep->due_ms || (record && record->is_sweeping)) {
            link = &sweep->next;
            continue;
        }
        if (record && record->is_swept) {
            record->needs_sweep = true;
            root_life_sweep_again(farm, record);
        }
        *link = sweep->next;
        free(sweep);
    }
}

void late_sweep_finish(struct farm *farm)
{
    while (farm->late_sweeps) {
        struct late_sweep *sweep = farm->late_sweeps;

        farm->late_sweeps = sweep->next;
        free(sweep);
    }
}
