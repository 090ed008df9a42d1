// The passes whose mean a frame is. Each is drawn with its own uniforms, for the picture and for its caches.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct job;
struct scene_program;

// The zero value is empty.
struct passes {
    unsigned char *blocks; // owned; block_bytes for each pass
    size_t block_bytes;    // the picture's uniforms, then those of each cache
    int count;
    bool are_still; // the passes differ in the points of a pixel alone; then one more stands for all: its centre
};

struct passes_params {
    const struct scene_program *scene;
    const struct job *job;
    int32_t frame;
    int stream; // of random paths
};

// Finds the passes of a frame: one where all would show the same.
bool passes_plan(struct passes *passes, const struct passes_params *params, struct error *error);
void passes_finish(struct passes *passes); // accepts an empty one
// The pass that shows the centre of each pixel, for the caller to draw alone. It borrows its block from `passes`, whose
// passes are still and several; never finished.
struct passes passes_centre(const struct passes *passes);
// Returns the uniforms of a pass; the picture's own come first.
const unsigned char *passes_block(const struct passes *passes, int pass);
// Points `blocks` at the uniforms of each of the scene's caches for a pass.
void passes_cache_blocks(const struct passes *passes, const struct scene_program *scene, int pass,
                         const unsigned char **blocks);
bool passes_are_equal(const struct passes *a, const struct passes *b);
