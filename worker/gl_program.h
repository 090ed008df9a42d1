// A linked GL program, and compile errors told by module name and line.
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct gl_functions;

struct gl_program_params {
    const char *vertex, *fragment;
    // What the N of `#line LINE N` in `fragment` stands for; in the vertex shader 0 is the full-screen triangle.
    const char *const *module_names;
    size_t module_count;
};

// Returns the program's GL name, or 0. The driver's first complaint is in `error`, the whole log at debug level.
unsigned gl_program_create(const struct gl_functions *gl, const struct gl_program_params *params, struct error *error);

// Rewrites the places of a driver's log ("3:12(5): error: ...", "3(12) : error ...", "ERROR: 3:12: ...") as
// "density/fold_fractal.glsl:12". Owned by the caller.
char *gl_program_translate_log(const char *log, const char *const *module_names, size_t module_count);
