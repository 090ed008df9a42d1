// The jobs of a daemon that a filter chooses, asked for page by page.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

#include <stdbool.h>
#include <stdint.h>

struct connection;
struct error;
struct json_node;

struct job_pages {
    const char *states, *owner, *name; // as in struct options; NULL: any
    int64_t since_s;                   // unix time; negative: ever
    int64_t limit;                     // only so many of the newest, which come first; 0 or less: all, by their ids
    bool (*on_job)(void *user, const struct json_node *job, struct error *error); // borrowed during the call
    void *user;
};

// A failure of `on_job` ends it with EXIT_STATUS_FAILED.
enum exit_status job_pages_read(const struct job_pages *pages, struct connection *connection, struct error *error);
