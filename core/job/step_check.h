// Whether a job's method suits its scene, and how many steps it would take along a ray at most.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_node;

// Messages name places in `document`, which `job` was read from. The size of a grid is not known here: whoever opens it
// counts the steps through it.
bool step_check(const struct job *job, const struct json_node *document, struct error *error);

// The longest way that a camera ray has in any medium but those of grids, m; INFINITY where nothing ends it, 0 without any.
double step_longest_way(const struct job *job);
