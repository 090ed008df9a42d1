// The text of a shader while it is assembled: modules, each once, and generated text between them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct error;

enum {
    SHADER_ASSEMBLY_MODULE_LIMIT = 72,
    // `#line` numbers the lines of module N from N * SHADER_ASSEMBLY_LINE_STRIDE + 1 on. GLSL's source string number
    // would be for this, but is 0 in some of Mesa's messages.
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
void shader_assembly_add(struct shader_assembly *assembly, const char *module); // if it is not in the text yet
// Says that generated text follows: its lines are those of the whole text.
void shader_assembly_generate(struct shader_assembly *assembly);
// Adds a module whose text is given; `name` outlives the users of module_names. Generated text follows.
void shader_assembly_add_text(struct shader_assembly *assembly, const char *name, const char *text);
// Returns the whole text, or NULL with the reason; either way nothing else is left to release.
char *shader_assembly_end(struct shader_assembly *assembly);
