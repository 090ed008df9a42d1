// Follows jobs until they have ended, by the daemon's events.
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
struct options;

struct follow_params {
    const int64_t *ids;       // borrowed
    size_t id_count;          // 0: all jobs, until interrupted
    bool shows_progress;      // on stderr
    bool prints_events;       // on stdout, one JSON object a line, the current state of the jobs first
    struct json_writer *jobs; // borrowed, or NULL; receives {"jobs":[...]} in their last states
    FILE *ends;               // borrowed, or NULL; receives a line for each job that ends, and stderr why a job waits
    const struct options *options; // borrowed: how to connect again, and how long to try
};

// EXIT_STATUS_DONE when all jobs succeeded, EXIT_STATUS_FAILED when one did not. Where the daemon is lost, that is said
// on stderr, and `*connection` is closed and replaced, or NULL where it does not come back in time.
enum exit_status follow_jobs(struct connection **connection, const struct follow_params *params, struct error *error);
