// Collects the errors that GL reports and notices a lost context.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct gl_functions;

enum gl_debug_state {
    GL_DEBUG_FINE,
    GL_DEBUG_ERROR,  // a call was wrong
    GL_DEBUG_MEMORY, // GL is out of memory
    GL_DEBUG_LOST    // the context was reset and cannot be used again
};

struct gl_debug {
    const struct gl_functions *gl; // borrowed; outlives us
    char first[512];               // the first message since the last check; empty: none
};

// GL keeps the address of `debug` until gl_debug_finish.
void gl_debug_init(struct gl_debug *debug, const struct gl_functions *gl);
void gl_debug_finish(struct gl_debug *debug); // accepts the zero value
// Returns what happened since the last check; `error` has the message.
enum gl_debug_state gl_debug_check(struct gl_debug *debug, struct error *error);
