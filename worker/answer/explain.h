// What a scene makes the renderer model, what it does not, and the shader: without a GL context.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_writer;

// Writes the result of `worker.explain` (docs/protocol.md) as one JSON object, `plan` (NULL: none), JSON itself, in it. A job
// that states a tolerance is explained as a plan has it.
bool explain_write(const struct job *job, const char *shader_dir, const struct json_writer *plan,
                   struct json_writer *writer, struct error *error);
