// One question to the daemon: connects, asks, hangs up.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"
#include "core/wire/message.h"

struct connection;
struct error;
struct json_writer;
struct options;

// Connects where the options and the environment say. On failure NULL, and `status` is the exit code to end with.
struct connection *daemon_call_connect(const struct options *options, enum exit_status *status, struct error *error);
// `params` is one JSON value; NULL: {}. On EXIT_STATUS_DONE the caller frees `reply` with message_finish.
enum exit_status daemon_call(const struct options *options, const char *method, const char *params,
                             struct message *reply, struct error *error);
// Writes member "state" as an array from "failed,canceled"; nothing when `states` is NULL.
void daemon_call_write_states(struct json_writer *params, const char *states);
// Reads the result for job `id`; prints it when `results` is NULL, else adds a value to it.
typedef bool daemon_call_tell(const struct json_node *result, int64_t id, struct json_writer *results,
                              struct error *error);

// For verbs of the form VERB ID...: calls `method` with each id, goes on with the others when one fails, and returns the
// first failure. `more` is what the params have beside the id (",\"files\":true", or empty), `key` names the array of results
// in what --json prints.
struct daemon_call_each {
    const char *method, *more, *key;
    daemon_call_tell *tell;
};
enum exit_status daemon_call_each(const struct options *options, const struct daemon_call_each *each,
                                  struct error *error);
// For those that are answered with the job: calls `method` likewise and prints what became of each job.
enum exit_status daemon_call_each_job(const struct options *options, const char *method, struct error *error);
