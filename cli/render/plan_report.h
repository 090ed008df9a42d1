// Asks a worker for the plan of a job that states a tolerance, and prints it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/program/exit_status.h"

struct error;
struct job_beyond;
struct json_node;
struct message;
struct options;

// Starts a worker to plan the job of `document` (worker.plan); `reply` as for connection_call.
enum exit_status plan_report_ask(const struct options *options, const char *document, struct message *reply,
                                 struct error *error);
// Prints a quality, its method and numbers by their keys in a job, and ends the line.
void plan_report_print_quality(const struct json_node *quality);
// Prints a result of worker.plan of a job that models so many orders of scattering (struct scene).
void plan_report_print(const struct json_node *plan, int orders);
// Reads what the first plan's orders leave out; nothing where it does not say.
void plan_report_find_beyond(const struct json_node *plan, struct job_beyond *beyond);
