// Takes a frame's settings from the header of a file that was rendered before, to render them again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct held_job;
struct json_node;

// Reads the file job->plan_of, which must be a planned frame of the same pictures. `document` is the job's.
bool plan_of_read(struct held_job *job, const struct json_node *document, struct error *error);
