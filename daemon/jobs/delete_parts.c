// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/delete_parts.h"

#include "core/base/alloc.h"
#include "daemon/farm/job_table.h"

#include <stdlib.h>

enum { ROWS_OF_A_PART = 20 * 1000 }; // as many are deleted in some 50 ms

static bool has_many_rows(const struct job_record *record)
{
    const int64_t *counts = record->queued->states.counts;

    return counts[FRAME_SUCCEEDED] + counts[FRAME_SKIPPED] + counts[FRAME_FAILED] > ROWS_OF_A_PART;
}

char *delete_parts_format_reason(const struct job_record *record, const char *user)
{
    return xasprintf("its deletion by %s has begun: march delete %lld ends it", user, (long long)record->id);
}

static struct store_op begin(const struct job_record *record, const char *user)
{
    struct store_op op = job_record_format_op(record);

    op.job.is_canceled = true;
    free(op.job.reason);
    op.job.reason = delete_parts_format_reason(record, user);
    return op;
}

static struct store_op delete_rows(struct delete_parts *parts, const struct job_record *record)
{
    int64_t left = record->queued->states.frame_count - parts->next;
    size_t count = (size_t)(left < ROWS_OF_A_PART ? left : ROWS_OF_A_PART);
    struct store_op op = {.kind = STORE_RESET_FRAMES, .reset = {.job = record->id, .count = count}};

    op.reset.indices = xcalloc(count, sizeof op.reset.indices[0]);
    for (size_t i = 0; i < count; i++)
        op.reset.indices[i] = (int32_t)parts->next++;
    return op;
}

struct store_op delete_parts_take(struct delete_parts *parts, const struct job_record *record, const char *user)
{
    bool was_begun = parts->has_begun;

    parts->has_begun = true;
    if (!was_begun && has_many_rows(record)) return begin(record, user);
    if (was_begun && parts->next < record->queued->states.frame_count) return delete_rows(parts, record);
    parts->is_last = true;
    return (struct store_op){.kind = STORE_DELETE_JOB, .job = {.id = record->id}};
}
