// Checks that involve several values of a job: geometry and phase weights at the frames, and method against scene.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_node;

// `job` was read from `document`, except for its hash. Messages name places in `document`.
bool job_check(const struct job *job, const struct json_node *document, struct error *error);

// True when a program in another folder can find the inputs of the job: paths are absolute, GLSL is there as text.
bool job_check_inputs(const struct job *job, const struct json_node *document, struct error *error);

// True when the job's name, comment, tags and output.path have no hidden characters (core/base/utf8.h), so that they
// are what people see. Asked of new jobs alone: one that was accepted before goes on.
bool job_check_names(const struct job *job, struct error *error);
