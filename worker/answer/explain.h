// Explains a job: what the renderer models of its scene, what it does not, and the shader. Needs no GL context.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_writer;

// Writes the result of `worker.explain` (docs/protocol.md) as one JSON object. `plan` is its member of that name, as
// JSON text; NULL: none. A job that does not state its method is passed as planned, or as its draft.
bool explain_write(const struct job *job, const char *shader_dir, const struct json_writer *plan,
                   struct json_writer *writer, struct error *error);
