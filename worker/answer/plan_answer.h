// What is foretold of a job that states a tolerance: a plan for some of its segments, in JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_writer;
struct plan;
struct request_tools;

// Plans the first, the middle and the last segment and writes one object, as docs/protocol.md has it under `worker.plan`.
// `first` (may be NULL) is the first segment's. Needs a renderer and a job of method auto.
bool plan_answer_write(const struct job *job, const struct request_tools *tools, struct json_writer *writer,
                       struct plan *first, struct error *error);
