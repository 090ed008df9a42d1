// Checks whether a job's orders of scattering, its lights and its method go together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_node;

// `document` is what the job was read from; the error names a place in it.
//
// Lights of many directions (light_rules.h's has_size) need random paths, and so does light that scatters more than
// once: method paths, or a march with a scatter_grid, or a planner that chooses one. Random paths go neither by mirrors
// nor through dielectrics, need to know how dense a medium may be, and must come to an end.
bool scattering_check(const struct job *job, const struct json_node *document, struct error *error);
// Refuses what the worker does not render.
bool scattering_check_is_rendered(const struct job *job, const struct json_node *document, struct error *error);
