// The text of a shader as it is put together: modules, each once, and what is generated between them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct density_site;
struct error;

enum { SHADER_ASSEMBLY_MODULE_LIMIT = 72 };

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
// Modules of a medium's density and bounds, and the job's own code, but for what density_kind.write emits.
void shader_assembly_add_density(struct shader_assembly *assembly, const struct density_site *site);
// The whole text, or NULL with the reason; either way nothing else is left to release.
char *shader_assembly_end(struct shader_assembly *assembly);
