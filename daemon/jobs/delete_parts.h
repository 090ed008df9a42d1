// The commits that delete a job from the store. Many rows go in parts: others' commits come between them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/store/store_op.h"

#include <stdbool.h>
#include <stdint.h>

struct job_record;

// The zero value is at the beginning.
struct delete_parts {
    bool has_begun, is_last; // of the op that was taken last
    int64_t next;            // rows of frames before this index are deleted
};

// The op to commit next, each in a commit of its own, until `is_last`. Where there are several, the first makes the job
// a canceled one, so that a crash before the last leaves a job of which no frame is queued. `user` deletes it.
struct store_op delete_parts_take(struct delete_parts *parts, const struct job_record *record, const char *user);
// The reason of such a job; owned by the caller.
char *delete_parts_format_reason(const struct job_record *record, const char *user);
