// Checks that a job's method suits its scene and does not take too many steps along a ray.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_node;

// Messages name places in `document`, from which `job` was read. The size of a grid is unknown here: the worker, which
// opens its file, counts the steps through it.
bool step_check(const struct job *job, const struct json_node *document, struct error *error);

// The longest path of a camera ray through a medium that is no grid, m. INFINITY where nothing bounds it, 0 without
// media.
double step_longest_path(const struct job *job);
// False where marches have no end, along camera rays or towards lights. Random paths end as they are absorbed.
bool step_has_end(const struct job *job);
// The diameter of the smallest medium whose density varies and is no grid, m; INFINITY where there is none.
double step_smallest_diameter(const struct job *job);
