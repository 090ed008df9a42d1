// Links a GL program and translates compile errors to module names and lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct gl_functions;

struct gl_program_params {
    const char *vertex, *fragment; // for a program that draws a picture
    const char *compute;           // for a program that draws none; NULL: it draws one
    // The modules of `fragment` or `compute`; the vertex shader is the full-screen triangle.
    const char *const *module_names;
    size_t module_count;
};

// Returns the program's GL name, or 0. `error` has the driver's first error; the whole log is logged at debug level.
unsigned gl_program_create(const struct gl_functions *gl, const struct gl_program_params *params, struct error *error);

// Rewrites the positions in a driver's log ("3:30012(5): error: ...", "3(30012) : error ...", "ERROR: 3:30012: ...") as
// "density/fold_fractal.glsl:12", and names private to a medium as its author wrote them. The caller owns the text.
char *gl_program_translate_log(const char *log, const char *const *module_names, size_t module_count);
