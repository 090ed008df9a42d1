// Whom march-web can tell, as it said last, and the check of a job's rules against it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job_notify.h"

#include <stdbool.h>
#include <stddef.h>

struct error;

enum { NOTICE_TARGETS_LIMIT = 256 };

// The zero value knows nothing: march-web has not asked since the daemon's start.
struct notice_targets {
    char **names; // owned
    size_t count, capacity;
    bool is_known;
    bool has_webhooks; // jobs may name addresses
};

void notice_targets_finish(struct notice_targets *targets);
void notice_targets_add(struct notice_targets *targets, const char *name); // copies
// False, with the rule that is wrong, when a rule names nobody who can be told. All rules are right while nothing is
// known.
bool notice_targets_check(const struct notice_targets *targets, const struct job_notify *notify, struct error *error);
