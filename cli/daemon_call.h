// One question to the daemon: connects, asks, hangs up.
#pragma once

#include "cli/exit_status.h"
#include "core/message.h"

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
// For verbs of the form VERB ID...: calls `method` with each id and prints what became of the job, or why it could not be
// done; goes on with the others and returns the first failure.
enum exit_status daemon_call_each_job(const struct options *options, const char *method, struct error *error);
