// Explains a job: what the renderer models of its scene, what it does not, and the shader. Needs no GL context.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct job;
struct job_beyond;
struct json_writer;

struct explain_params {
    const struct job *job;           // one that does not state its method is passed as planned, or as its draft
    const char *shader_dir;          // NULL: the embedded modules
    const struct json_writer *plan;  // the member of that name, as JSON text; NULL: none
    const struct job_beyond *beyond; // what the modelled orders of scattering leave out
};

// Writes the result of `worker.explain` (docs/protocol.md) as one JSON object.
bool explain_write(const struct explain_params *params, struct json_writer *writer, struct error *error);
