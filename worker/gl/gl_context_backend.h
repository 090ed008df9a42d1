// How one way to reach GL makes a context; private to gl_context*.c.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/gl/gl_context.h"

struct gl_context {
    struct gl_context_facts facts;
    gl_function *(*function)(const struct gl_context *context, const char *name);
    void (*destroy)(struct gl_context *context); // releases what the backend holds and frees the context
};

// What was tried and why it failed, one clause a try. The zero value is empty.
struct gl_context_trials {
    char *text; // owned
};

void gl_context_trials_add(struct gl_context_trials *trials, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

enum gl_context_egl_devices {
    GL_CONTEXT_EGL_HARDWARE,
    GL_CONTEXT_EGL_SOFTWARE // software devices, then the surfaceless platform
};

// Each returns a current context with `function`, `destroy` and the facts only it knows, or NULL with its tries added.
// `device` is as for gl_context_create and, if given, overrides `devices`.
struct gl_context *gl_context_egl_create(enum gl_context_egl_devices devices, const char *device,
                                         struct gl_context_trials *trials);
struct gl_context *gl_context_osmesa_create(struct gl_context_trials *trials);

// Reads vendor, renderer, version and, where GL tells it, the device's UUID. False when GL is older than 4.5.
bool gl_context_read_facts(struct gl_context *context, struct gl_context_trials *trials);
void gl_context_format_uuid(const unsigned char bytes[static 16], char text[static 40]);
