// Texts of the shader modules: embedded in the program, or from a folder while developing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;

struct shader_source {
    const char *name; // "density/fold_fractal.glsl"
    const char *text;
};

extern const struct shader_source shader_sources_embedded[]; // ends in a NULL name

// Returns the module's text, owned by the caller: DIR/NAME where `shader_dir` (may be NULL) has it, else the embedded
// one.
char *shader_sources_load(const char *shader_dir, const char *name, struct error *error);
