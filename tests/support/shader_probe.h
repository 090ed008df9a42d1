// Evaluates shader modules at many inputs and returns the results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct gl_functions;

enum { SHADER_PROBE_INPUT_LIMIT = 1024 }; // vec4s: what every GL 4.5 takes as one block

struct shader_probe_params {
    const char *const *modules; // names of shader modules in the order of their use, ends in NULL
    const char *head;           // GLSL that the modules suppose; NULL: none
    // GLSL that defines `vec4 probe(int index)` and reads `inputs[]`.
    const char *body;
    const float (*inputs)[4];
    size_t input_count; // vec4s
    size_t count;       // outputs: probe(0), probe(1), ...
    bool on_egl;        // else in software
    // Binds what the body samples, and deletes it; NULL: nothing.
    void (*bind)(const struct gl_functions *gl, void *user);
    void (*release)(void *user);
    void *user;
};

// Fails the test when something does not compile.
void shader_probe_run(const struct shader_probe_params *params, float (*outputs)[4]);
