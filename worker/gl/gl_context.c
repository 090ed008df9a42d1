// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_context.h"

#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/gl/gl_context_backend.h"
#include "worker/gl/gl_device.h"

#include <stdlib.h>

enum { TRY_LIMIT = 3 };

// The order in which backends are tried. A device that the caller names is looked for by the first alone.
static gl_context_backend_create *const tries[][TRY_LIMIT] = {
    [GL_BACKEND_AUTO] = {gl_context_egl_create_hardware, gl_context_osmesa_create, gl_context_egl_create_software},
    [GL_BACKEND_EGL] = {gl_context_egl_create_hardware, gl_context_egl_create_software},
    [GL_BACKEND_OSMESA] = {gl_context_osmesa_create},
    [GL_BACKEND_SOFTWARE] = {gl_context_osmesa_create, gl_context_egl_create_software},
};

struct gl_context *gl_context_create(enum gl_backend backend, const char *device, struct error *error)
{
    struct gl_context_trials trials = {0};
    struct gl_context *context = NULL;
    int turn;
    bool is_turn = device && gl_device_read_turn(device, &turn);

    for (int i = 0; i < TRY_LIMIT && tries[backend][i] && !context && (i == 0 || !device || is_turn); ++i)
        context =
            tries[backend][i](is_turn && tries[backend][i] != gl_context_egl_create_hardware ? NULL : device, &trials);
    if (context)
        log_debug("gl: %s on %s, %s", context->facts.backend, context->facts.renderer, context->facts.version);
    else
        error_set(error, "no OpenGL 4.5 context; tried: %s", trials.text ? trials.text : "nothing");
    free(trials.text);
    return context;
}

void gl_context_destroy(struct gl_context *context)
{
    if (context) context->destroy(context);
}

const struct gl_context_facts *gl_context_facts(const struct gl_context *context)
{
    return &context->facts;
}

gl_function *gl_context_function(const struct gl_context *context, const char *name)
{
    return context->function(context, name);
}
