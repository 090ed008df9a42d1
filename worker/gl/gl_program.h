// A linked GL program, and compile errors told by module name and line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct gl_functions;

struct gl_program_params {
    const char *vertex, *fragment; // of a picture
    const char *compute;           // of a program without a picture; NULL: it has one
    // Of `fragment` or `compute`; the vertex shader is the full-screen triangle.
    const char *const *module_names;
    size_t module_count;
};

// Returns the program's GL name, or 0. The driver's first complaint is in `error`, the whole log at debug level.
unsigned gl_program_create(const struct gl_functions *gl, const struct gl_program_params *params, struct error *error);

// Rewrites the places of a driver's log ("3:30012(5): error: ...", "3(30012) : error ...", "ERROR: 3:30012: ...") as
// "density/fold_fractal.glsl:12", and names private to a medium as its author wrote them. Owned by the caller.
char *gl_program_translate_log(const char *log, const char *const *module_names, size_t module_count);
