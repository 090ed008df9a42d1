// Checks whether a job's orders of scattering, its lights and its method go together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_node;

// `document` is what the job was read from; the error names a place in it.
bool scattering_check(const struct job *job, const struct json_node *document, struct error *error);
