// One GL 4.5 core context without a window, current on the thread that made it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct gl_context;

typedef void gl_function(void);

enum gl_backend {
    GL_BACKEND_AUTO, // EGL on a GPU, then OSMesa, then EGL on software
    GL_BACKEND_EGL,
    GL_BACKEND_OSMESA
};

struct gl_context_facts {
    const char *backend; // "egl" or "osmesa"
    char vendor[128], renderer[128], version[128];
    char device_uuid[40]; // 8-4-4-4-12; empty when unknown
    bool is_software;
};

// `device` picks an EGL device by UUID or index; NULL: the first that works. Loads libEGL or libOSMesa at run time.
struct gl_context *gl_context_create(enum gl_backend backend, const char *device, struct error *error);
void gl_context_destroy(struct gl_context *context);
const struct gl_context_facts *gl_context_facts(const struct gl_context *context);
// To be cast to the function's own type; NULL when GL lacks it.
gl_function *gl_context_function(const struct gl_context *context, const char *name);
