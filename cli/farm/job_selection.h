// Which jobs a verb means: those that are named, or those that --all, --owner and --state choose.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

#include <stddef.h>
#include <stdint.h>

struct connection;
struct error;
struct options;

struct job_selection {
    int64_t *ids; // owned
    size_t count;
};

// What the verb does ("cancel"), and to jobs in which states where --state names none ("queued,running,paused").
struct job_selection_params {
    const char *verb, *states;
};

// Checks the operands without a daemon: ids, or options that choose jobs, but not both. EXIT_STATUS_DONE or _USAGE.
enum exit_status job_selection_check(const struct options *options, struct error *error);
// Finds the jobs. Where options choose them, their count is said on stderr first, and it goes on only with --yes or a
// yes on the terminal. After EXIT_STATUS_DONE the caller finishes the selection, which may be empty.
enum exit_status job_selection_find(struct job_selection *selection, struct connection *connection,
                                    const struct options *options, const struct job_selection_params *params,
                                    struct error *error);
void job_selection_finish(struct job_selection *selection);
