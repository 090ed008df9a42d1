// When a job tells why it waits, or that a frame missed: once while that lasts, and not where it flickers. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

// The numbers are in stores.
enum notice_cause {
    NOTICE_HELD = 0,    // a fault has paused the job
    NOTICE_ROOT = 1,    // its output root is away
    NOTICE_WORKERS = 2, // no worker can render it
    NOTICE_MISSED = 3   // a frame is over the tolerance
};
enum { NOTICE_CAUSE_COUNT = NOTICE_MISSED + 1 };

// Of one cause. The zero value has never been there.
struct notice_told {
    int64_t since_ms; // when it began; 0: it is not there
    int64_t told_ms;  // when the job told of it; 0: never
    bool is_on;       // the job told, and it has been there since
};

enum notice_step {
    NOTICE_NOTHING,
    NOTICE_TELL,  // the target is to be told, and `told` stored
    NOTICE_FORGET // the cause is over: `told` is to be stored
};

// `now_ms` is unix time.
enum notice_step notice_causes_note(struct notice_told *told, enum notice_cause cause, bool is_there, int64_t now_ms);
