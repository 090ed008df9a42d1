// A GL context for a test, and a renderer on it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/gl/gl_context.h"

struct renderer;

struct gl_stage {
    struct gl_context *context;
    struct renderer *renderer;
};

// Opens a context; free with gl_context_destroy. A missing backend skips the test, missing software fails it.
struct gl_context *gl_stage_open_context(enum gl_backend backend);
// `shader_dir` as renderer_create has it.
struct gl_stage gl_stage_open(enum gl_backend backend, const char *shader_dir);
void gl_stage_close(struct gl_stage stage);
