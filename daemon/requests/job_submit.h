// Submits a job: checks the document, the limits and the output files, commits the job, queues it, answers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"

#include <stdbool.h>

struct farm;
struct request;

// False, with the request's code and error filled, when the request is refused at once; else its message's root is
// taken, the document is read and checked off the loop, and the answer comes later.
bool job_submit_start(struct request *request, const struct json_node *document, bool paused);
// To be called when a job is swept: goes on with submissions that waited for it to leave its files.
void job_submit_go_on(struct farm *farm);
