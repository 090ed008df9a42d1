// What a job's modelled orders of scattering leave out: a worker measures it, and people are told in a sentence.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job_beyond.h"

struct job;
struct json_node;
struct options;

// Has a worker without GL measure it (worker.beyond). Nothing is told where all orders are modelled, or where no worker
// can be started or none can read the job's files.
void beyond_report_ask(const struct options *options, const struct job *job, const char *document,
                       struct job_beyond *beyond);
// The same from the member "beyond" of an answer.
void beyond_report_read(const struct json_node *answer, struct job_beyond *beyond);
// Prints a warning on stderr where it is known and more than the job's tolerance.
void beyond_report_warn(const struct job_beyond *beyond, const struct job *job);
