// Names that a user's GLSL text brings into the shader that it becomes part of, and what such a text may not contain.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct error;

struct glsl_name {
    char *text;      // owned
    char *signature; // owned; of a function: "float density(vec3, float)"; else NULL
    int line;
    bool is_macro;
    bool has_body; // of a function
};

// The zero value is empty.
struct glsl_names {
    struct glsl_name *names; // owned; those declared outside of functions; a function once for each declaration
    size_t count, capacity;
};

// Reads the names. Refuses what would reach beyond the text itself: directives that steer the compiler, interfaces
// (uniform, in, out, layout, buffer), built-in variables, `discard`, and names of `taken` (ends in NULL), which the
// shader needs. Braces, comments and #if must be closed, and all but comments be ASCII. Errors begin with "FILE:LINE:
// ". Other mistakes are left to the compiler.
bool glsl_names_read(struct glsl_names *names, const char *file, const char *text, const char *const *taken,
                     struct error *error);
void glsl_names_finish(struct glsl_names *names); // accepts an empty one

// Writes lines that make every name PREFIX_name (a macro keeps its own) in the text that follows, until the lines of
// `hide`.
void glsl_names_write_private(const struct glsl_names *names, const char *prefix, FILE *out);
void glsl_names_write_hide(const struct glsl_names *names, FILE *out);
