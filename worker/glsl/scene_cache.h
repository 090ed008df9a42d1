// A 3D texture that a compute program fills before the picture's passes, and that shaders then sample.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/scene/scene.h"
#include "worker/glsl/frame_uniforms.h"
#include "worker/glsl/shader_assembly.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    SCENE_CACHE_LIMIT = 2 * (SCENE_LIGHT_LIMIT + SCENE_MEDIUM_LIMIT) + 3,
    SCENE_CACHE_GROUP_SIDE = 8 // invocations of a group along x and y
};

enum { SCENE_CACHE_STEPS = 16 };

// Random walks, and how often they looked at media.
struct scene_cache_walks {
    double walks, steps;
};

enum scene_cache_format { SCENE_CACHE_R32F, SCENE_CACHE_RG32F, SCENE_CACHE_RGBA32F };

// The zero value is empty.
//
// The program runs once for each (x, y, z) below `invocations` and writes all texels, each once: those of a ray along
// z, or a single texel. Its text begins as scene_cache_begin writes it and declares `uniforms`. A texture is filled
// anew when any of these changes: the text, the packed uniforms, format and size, the files or a cache that it reads.
struct scene_cache {
    char name[32]; // of the sampler in shaders that read it
    unsigned unit; // the texture unit for these shaders, bound as GL_LINEAR and clamped to the edge
    char *text;    // owned; `#line` numbers it as shader_assembly.h says
    const char *module_names[SHADER_ASSEMBLY_MODULE_LIMIT]; // as shader_assembly.h has them
    size_t module_count;
    char hash[HASH_TEXT_SIZE];      // of the text
    struct frame_uniforms uniforms; // refers to the job and the inputs
    enum scene_cache_format format;
    int size[3];        // texels
    int invocations[3]; // at most `size`, unless it takes turns
    // The program runs again, over texels that begin as 0 and that it reads, until no invocation has set
    // `cache_is_unfinished` to 1. Invocations are the program's own: each may write any texels.
    bool takes_turns;
    // Not 0: there are so many parts of the work of a program that takes turns; it sets no `cache_is_unfinished`.
    // Invocations, as many as the processors like, take one after the other by uint cache_take(), whose numbers are not
    // below `part_count` when all are taken. A turn ends where each gives back by cache_leave(number) what it has not
    // done. `invocations` are the most that run at once.
    size_t part_count;
    // Whole numbers beside the texture, which begin as 0 and which the program adds to; the next cache reads them.
    size_t sum_count;
    bool reads_sums; // of the cache before; with a sum_count of its own it adds to them, too
    // The last sums are the number of random walks that it has begun, and a SCENE_CACHE_STEPS-th of their steps.
    bool counts_walks;
    bool is_step;     // only other caches read it: it is released when they are filled
    bool reads_files; // its values depend on the frame's files
    uint64_t reads;   // bit i: it samples cache i of the program, an earlier one
};

void scene_cache_finish(struct scene_cache *cache); // accepts an empty one
// Hashes all that the values follow from, except uniforms, files and the caches that it reads.
void scene_cache_hash(const struct scene_cache *cache, char hash[static HASH_TEXT_SIZE]);
size_t scene_cache_size_bytes(const struct scene_cache *cache); // of the texture, with its sums
// Begins a program's text: version, layout, the image `cache_image` to write to, and bool cache_find_invocation(out
// ivec3 at), which is false where there is nothing to do. On failure the cache is empty.
bool scene_cache_begin(struct scene_cache *cache, struct shader_assembly *text, const char *shader_dir,
                       struct error *error);
// Takes the text over and hashes it. On failure, whose reason is in scene_cache_begin's `error`, the cache is
// empty.
bool scene_cache_end(struct scene_cache *cache, struct shader_assembly *text);
