// Says how often a job's light scatters, by which paths that is found, and what it leaves out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct job;
struct job_beyond;

enum { EXPLAIN_SCATTERING_SIZE = 512 };

// Writes a sentence without its full stop. Returns whether light that is scattered more than once is modelled.
bool explain_scattering(const struct job *job, const struct job_beyond *beyond,
                        char why[static EXPLAIN_SCATTERING_SIZE]);
