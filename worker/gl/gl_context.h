// One GL 4.5 core context without a window, current on the thread that made it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/gl/gl_context_facts.h"

struct error;
struct gl_context;

enum gl_backend {
    GL_BACKEND_AUTO, // EGL on a GPU, then OSMesa, then EGL on software
    GL_BACKEND_EGL,
    GL_BACKEND_OSMESA,
    GL_BACKEND_SOFTWARE // OSMesa, then EGL on software
};

// `device` picks an EGL device by UUID or index, or, with "turn:N", the first of the GPUs that works from the N-th on,
// as gl_device_order says with CUDA_VISIBLE_DEVICES; NULL: the first that works. Loads libEGL or libOSMesa at run time.
struct gl_context *gl_context_create(enum gl_backend backend, const char *device, struct error *error);
void gl_context_destroy(struct gl_context *context);
const struct gl_context_facts *gl_context_facts(const struct gl_context *context);
// NULL when GL lacks the function.
gl_function *gl_context_function(const struct gl_context *context, const char *name);
