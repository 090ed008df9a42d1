// Says how often a job's light scatters, and by which paths that is found.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct job;

enum { EXPLAIN_SCATTERING_SIZE = 192 };

// Writes a sentence without its full stop. Returns whether light that is scattered more than once is modelled.
bool explain_scattering(const struct job *job, char why[static EXPLAIN_SCATTERING_SIZE]);
