// What a job that comes after others waits for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/schedule/queue.h"

struct farm;
struct job_record;

// Whether it waits, and whether that is in vain.
enum queue_wait after_look_find_wait(const struct farm *farm, const struct job_record *record);
// What it waits for, or why that is in vain; owned by the caller.
char *after_look_format_reason(const struct farm *farm, const struct job_record *record);
