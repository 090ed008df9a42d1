// What every backend gives a context, and what they share in making one; private to gl_context*.c.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/gl/gl_context_facts.h"

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

// Returns a current context with `function`, `destroy` and all facts, or NULL after adding what it tried to `trials`.
// `device` is as for gl_context_create.
typedef struct gl_context *gl_context_backend_create(const char *device, struct gl_context_trials *trials);

// EGL on a GPU, or on `device` whatever it is.
gl_context_backend_create gl_context_egl_create_hardware;
// EGL on a software device, else on the surfaceless platform.
gl_context_backend_create gl_context_egl_create_software;
// OSMesa has no devices: naming one fails.
gl_context_backend_create gl_context_osmesa_create;

// Reads vendor, renderer, version and, where GL tells it, the device's UUID. False when GL is older than 4.5.
bool gl_context_read_facts(struct gl_context *context, struct gl_context_trials *trials);
void gl_context_format_uuid(const unsigned char bytes[static 16], char text[static 40]);
