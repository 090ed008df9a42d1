// SPDX-License-Identifier: Apache-2.0
#include "tests/support/gl_stage.h"

#include "core/base/error.h"
#include "tests/support/keep_libraries.h"
#include "worker/render/renderer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

struct gl_context *gl_stage_open_context(enum gl_backend backend)
{
    struct error error = {{0}};
    struct gl_context *context = gl_context_create(backend, NULL, &error);

    if (!context && backend != GL_BACKEND_SOFTWARE) {
        print_message("skipped: %s\n", error.message);
        skip();
    }
    if (!context) fail_msg("%s", error.message);
    keep_libraries();
    return context;
}

struct gl_stage gl_stage_open(enum gl_backend backend, const char *shader_dir)
{
    struct gl_stage stage = {.context = gl_stage_open_context(backend)};

    stage.renderer = renderer_create(stage.context, shader_dir);
    return stage;
}

void gl_stage_close(struct gl_stage stage)
{
    renderer_destroy(stage.renderer);
    gl_context_destroy(stage.context);
}
