// Follows jobs by the daemon's events until they have ended.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct connection;
struct error;
struct json_writer;

struct follow_params {
    const int64_t *ids;       // borrowed
    size_t id_count;          // 0: all jobs, until interrupted
    bool shows_progress;      // on stderr
    bool prints_events;       // on stdout, a JSON object a line; begins with the jobs as they are
    struct json_writer *jobs; // borrowed; may be NULL: receives {"jobs":[...]} as they ended
    FILE *ends;               // borrowed; may be NULL: a line a job, how it ended
};

// EXIT_STATUS_DONE when all jobs succeeded, EXIT_STATUS_FAILED when one did not.
enum exit_status follow_jobs(struct connection *connection, const struct follow_params *params, struct error *error);
