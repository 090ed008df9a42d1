// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/keep.h"

#include <stdlib.h>

static int compare(const void *a, const void *b)
{
    const struct keep_job *one = a, *other = b;

    if (one->finished_ms != other->finished_ms) return one->finished_ms < other->finished_ms ? -1 : 1;
    return one->id < other->id ? -1 : one->id > other->id;
}

void keep_sort(struct keep_job *jobs, size_t count)
{
    if (count > 0) qsort(jobs, count, sizeof *jobs, compare);
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

struct keep_choice keep_choose(const struct keep_rules *rules, const struct keep_job *jobs, size_t count,
                               int64_t now_ms)
{
    struct keep_choice choice = {0};
    int64_t bytes = 0;

    if (rules->jobs > 0 && (int64_t)count > rules->jobs) choice.by_jobs = count - (size_t)rules->jobs;
    while (rules->ms > 0 && choice.by_ms < count && jobs[choice.by_ms].finished_ms + rules->ms < now_ms)
        choice.by_ms++;
    for (size_t i = count; rules->bytes > 0 && i > 0; i--) {
        bytes += jobs[i - 1].bytes;
        if (bytes <= rules->bytes) continue;
        choice.by_bytes = i;
        break;
    }
    choice.count = larger(choice.by_jobs, larger(choice.by_ms, choice.by_bytes));
    return choice;
}

const char *keep_rule_of(const struct keep_choice *choice, size_t index)
{
    return index < choice->by_ms ? "keep-days" : index < choice->by_jobs ? "keep-jobs" : "keep-bytes";
}
