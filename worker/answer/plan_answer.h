// Predictions for a job that states a tolerance: the plans of some of its segments, as JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_writer;
struct plan;
struct request_tools;

// Plans the first, the middle and the last segment and writes one object, the result of `worker.plan`
// (docs/protocol.md). `first` (may be NULL) receives the first segment's plan. Needs a renderer and a job of method
// auto.
bool plan_answer_write(const struct job *job, const struct request_tools *tools, struct json_writer *writer,
                       struct plan *first, struct error *error);
