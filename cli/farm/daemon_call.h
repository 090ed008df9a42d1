// Sends one request to the daemon on a connection of its own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/farm/job_selection.h"
#include "cli/program/exit_status.h"
#include "core/wire/message.h"

struct connection;
struct error;
struct json_writer;
struct options;

// The one socket that the options or the environment name; NULL: none, so that the usual ones are tried. Borrowed.
const char *daemon_call_socket(const struct options *options);
// Connects to the socket that options or environment name. On failure NULL, and `status` is the exit status to end
// with.
struct connection *daemon_call_connect(const struct options *options, enum exit_status *status, struct error *error);
// `params` is one JSON value; NULL: {}. On EXIT_STATUS_DONE the caller frees `reply` with message_finish.
enum exit_status daemon_call(const struct options *options, const char *method, const char *params,
                             struct message *reply, struct error *error);
// Reads the result for job `id`. Prints it when `results` is NULL, else appends a value to `results`.
typedef bool daemon_call_report(const struct json_node *result, int64_t id, struct json_writer *results,
                                struct error *error);

// For verbs of the form VERB ID..., or VERB with options that choose jobs: calls `method` with each id, continues when
// one fails, and returns the first failure. `more` is appended to the id in the params (",\"files\":true", or empty).
// `key` is the name of the array of results in the output of --json.
struct daemon_call_each {
    const char *method, *more, *key;
    daemon_call_report *report;
    struct job_selection_params selection;
};
enum exit_status daemon_call_each(const struct options *options, const struct daemon_call_each *each,
                                  struct error *error);
// For methods whose result is the job: prints each job's new state.
enum exit_status daemon_call_each_job(const struct options *options, const char *method,
                                      const struct job_selection_params *selection, struct error *error);
