// What a frame is the mean of: each pass is drawn with uniforms of its own, the picture's and those of its caches.
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
    unsigned char *blocks; // owned; NULL where nothing moves
    size_t block_bytes;    // of a pass: the picture's uniforms, then those of each cache
    int count;
};

// The passes of a frame; those that would show the same are one.
bool passes_plan(struct passes *passes, const struct scene_program *scene, const struct job *job, int32_t frame,
                 struct error *error);
void passes_finish(struct passes *passes); // accepts an empty one
// What a pass is drawn with; its first bytes are the picture's own.
const unsigned char *passes_block(const struct passes *passes, int pass);
// Where the block of each cache of the scene is for a pass.
void passes_cache_blocks(const struct passes *passes, const struct scene_program *scene, int pass,
                         const unsigned char **blocks);
bool passes_are_equal(const struct passes *a, const struct passes *b);
