// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/gl_functions.h"

#include "core/base/error.h"
#include "worker/gl/gl_context.h"

bool gl_functions_load(struct gl_functions *gl, const struct gl_context *context, struct error *error)
{
#define GL_FUNCTION_LOAD(type, name)                                                                                   \
    gl->name = (type)gl_context_function(context, "gl" #name);                                                         \
    if (!gl->name) {                                                                                                   \
        error_set(error, "GL lacks gl" #name);                                                                         \
        return false;                                                                                                  \
    }
    GL_FUNCTIONS(GL_FUNCTION_LOAD)
#undef GL_FUNCTION_LOAD
    return true;
}
