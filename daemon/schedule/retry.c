// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/retry.h"

#include <limits.h>
#include <stddef.h>

enum { BACKOFF_FIRST_MS = 1000, BACKOFF_LIMIT_MS = 60 * 1000 };

const char *const retry_fault_names[] = {"job",  "frame",   "worker", "output", "root",
                                         "lost", "endless", "cut",    "missed", NULL};

enum retry_action retry_decide(enum retry_fault fault, bool is_started, int tries, int max_attempts)
{
    switch (fault) {
    case RETRY_FAULT_JOB:
        return RETRY_FAIL_JOB;
    case RETRY_FAULT_OUTPUT:
        return RETRY_PAUSE_JOB;
    case RETRY_FAULT_ROOT:
        return RETRY_AWAIT_ROOT;
    case RETRY_FAULT_WORKER:
    case RETRY_FAULT_LOST:
        if (!is_started) return RETRY_FREE;
        break;
    case RETRY_FAULT_ENDLESS:
    case RETRY_FAULT_CUT:
    case RETRY_FAULT_MISSED:
        return is_started ? RETRY_FAIL_FRAME : RETRY_FREE;
    case RETRY_FAULT_FRAME:
        break;
    }
    return tries < max_attempts ? RETRY_FRAME : RETRY_FAIL_FRAME;
}

bool retry_blames_host(enum retry_fault fault)
{
    return fault != RETRY_FAULT_ROOT && fault != RETRY_FAULT_ENDLESS && fault != RETRY_FAULT_CUT &&
           fault != RETRY_FAULT_MISSED;
}

bool retry_gives_up_job(int64_t failed, int64_t done)
{
    return failed >= RETRY_HOPELESS_LIMIT && done == 0;
}

void retry_backoff_fail(struct retry_backoff *backoff, int64_t now_ms)
{
    int64_t wait_ms = BACKOFF_FIRST_MS;

    for (int i = 0; i < backoff->failures && wait_ms < BACKOFF_LIMIT_MS; i++)
        wait_ms *= 2;
    if (wait_ms > BACKOFF_LIMIT_MS) wait_ms = BACKOFF_LIMIT_MS;
    if (backoff->failures < INT_MAX) backoff->failures++;
    backoff->until_ms = now_ms + wait_ms;
}

void retry_backoff_succeed(struct retry_backoff *backoff)
{
    *backoff = (struct retry_backoff){0};
}

int64_t retry_backoff_wait_ms(const struct retry_backoff *backoff, int64_t now_ms)
{
    return backoff->failures && backoff->until_ms > now_ms ? backoff->until_ms - now_ms : 0;
}
