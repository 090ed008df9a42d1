// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_debug.h"

#include "core/base/error.h"
#include "core/base/log.h"
#include "worker/gl/gl_functions.h"

#include <stdio.h>

static void APIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                                const GLchar *message, const void *user)
{
    struct gl_debug *debug = (struct gl_debug *)user;

    if (type != GL_DEBUG_TYPE_ERROR) return;
    log_debug("gl: %.*s", (int)length, message);
    if (!debug->first[0]) snprintf(debug->first, sizeof debug->first, "%.*s", (int)length, message);
}

void gl_debug_init(struct gl_debug *debug, const struct gl_functions *gl)
{
    *debug = (struct gl_debug){.gl = gl};
    gl->Enable(GL_DEBUG_OUTPUT);
    gl->Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    gl->DebugMessageCallback(on_message, debug);
}

void gl_debug_finish(struct gl_debug *debug)
{
    if (debug->gl) debug->gl->DebugMessageCallback(NULL, NULL);
    *debug = (struct gl_debug){0};
}

static const char *reset_name(GLenum status)
{
    switch (status) {
    case GL_GUILTY_CONTEXT_RESET:
        return "by what it was rendering";
    case GL_INNOCENT_CONTEXT_RESET:
        return "by another program";
    default:
        return "for an unknown reason";
    }
}

enum gl_debug_state gl_debug_check(struct gl_debug *debug, struct error *error)
{
    GLenum status = debug->gl->GetGraphicsResetStatus();
    GLenum code = status == GL_NO_ERROR ? debug->gl->GetError() : GL_CONTEXT_LOST;
    enum gl_debug_state state = GL_DEBUG_FINE;

    if (code == GL_CONTEXT_LOST) {
        error_set(error, "the GL context is lost: reset %s", reset_name(status));
        state = GL_DEBUG_LOST;
    } else if (code == GL_OUT_OF_MEMORY) {
        error_set(error, "GL is out of memory%s%s", debug->first[0] ? ": " : "", debug->first);
        state = GL_DEBUG_MEMORY;
    } else if (code != GL_NO_ERROR || debug->first[0]) {
        error_set(error, "GL error 0x%04x%s%s", code, debug->first[0] ? ": " : "", debug->first);
        state = GL_DEBUG_ERROR;
    }
    debug->first[0] = '\0';
    return state;
}
