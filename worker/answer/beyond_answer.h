// Answers worker.beyond: what the modelled orders of scattering leave out, before anything is rendered.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job_beyond.h"
#include "worker/answer/request.h"

// Measures it for a job of any method, in as much time as linking a program takes. False when nobody waits any longer.
bool beyond_answer_find(const struct job *job, const struct request_tools *tools, struct job_beyond *beyond,
                        struct error *error);

request_function beyond_answer;
