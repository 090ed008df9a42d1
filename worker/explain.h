// What a scene makes the renderer model, what it does not, and the shader: without a GL context.
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct json_writer;

// Writes the result of `worker.explain` (docs/protocol.md) as one JSON object.
bool explain_write(const struct job *job, const char *shader_dir, struct json_writer *writer, struct error *error);
