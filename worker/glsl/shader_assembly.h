// The text of a shader as it is put together: modules, each once, and what is generated between them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct error;

enum {
    SHADER_ASSEMBLY_MODULE_LIMIT = 72,
    // `#line` gives the lines of module N the numbers N * SHADER_ASSEMBLY_LINE_STRIDE + 1 and up. The source string number
    // that GLSL has for this is 0 in some of Mesa's messages.
    SHADER_ASSEMBLY_LINE_STRIDE = 10000
};

// The zero value is empty.
struct shader_assembly {
    const char *shader_dir; // as for shader_sources_load; borrowed
    FILE *out;              // where generated text goes
    char *text;             // owned, until shader_assembly_end hands it over
    size_t length;
    // [0] is "generated", whose lines are those of the whole text; static strings, or borrowed from the job.
    const char *module_names[SHADER_ASSEMBLY_MODULE_LIMIT];
    size_t module_count;
    bool has_failed; // a module could not be read; `error` says which
    struct error *error;
};

bool shader_assembly_begin(struct shader_assembly *assembly, const char *shader_dir, struct error *error);
void shader_assembly_add(struct shader_assembly *assembly, const char *module); // unless it is there
// What follows is generated: its lines are those of the whole text.
void shader_assembly_generate(struct shader_assembly *assembly);
// A module whose text is at hand; `name` outlives the assembly's users. What follows is generated.
void shader_assembly_add_text(struct shader_assembly *assembly, const char *name, const char *text);
// The whole text, or NULL with the reason; either way nothing else is left to release.
char *shader_assembly_end(struct shader_assembly *assembly);
