// The numbers of a shader: constants of the job by name, and what moves, packed for each frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct error;
struct job;

enum frame_value_type {
    FRAME_VALUE_FLOAT,
    FRAME_VALUE_VEC3,
    FRAME_VALUE_MAT3 // column-major
};

// What a value follows from.
enum frame_value_origin {
    FRAME_VALUE_OF_TIME, // evaluate() says it
    FRAME_VALUE_OF_PLAN, // and that at any time; no motion
    FRAME_VALUE_FRAME_SEED,
    FRAME_VALUE_SAMPLE_INDEX
};

// What one pass over a frame shows.
struct frame_moment {
    double time; // s
    uint32_t frame_seed;
    int sample_index;
};

// Computes a value from what describes it, in double precision.
typedef void frame_value_evaluate(const void *source, double time, double value[static 9]);

struct frame_value {
    char name[48];
    enum frame_value_type type;
    enum frame_value_origin origin;
    bool is_constant; // of time 0, or seed and index 0
    frame_value_evaluate *evaluate;
    bool is_position;                      // in the world, m: the shader has it from the anchor on
    frame_value_evaluate *evaluate_linear; // of a shift: the matrix that goes with it, which takes places; else NULL
    const void *source;                    // borrowed from the job, which outlives us
    double min, max;                       // what a component may be at any time
    const char *meaning;                   // the place in the job, for messages; borrowed, static
    size_t offset_bytes;                   // of what moves, in the std140 block
};

// The zero value is empty.
struct frame_uniforms {
    const struct job *anchored; // borrowed; places are told from its anchor (scene_anchor.h); NULL: from the origin
    struct frame_value *values; // owned
    size_t count, capacity;
    size_t size_bytes; // of the block, a multiple of 16; 0 when nothing moves
    size_t end_bytes;  // of the last member that moves
};

void frame_uniforms_finish(struct frame_uniforms *uniforms);
// Adds `value` under a name, which it need not have yet.
__attribute__((format(printf, 3, 4))) void frame_uniforms_add(struct frame_uniforms *uniforms, struct frame_value value,
                                                              const char *name_format, ...);
// Writes a `const` for what is fixed; for what moves the block FrameUniforms and a variable, set by
// `frame_uniforms_read()`, which main() calls first. Either way the shader has it by its name.
void frame_uniforms_declare(const struct frame_uniforms *uniforms, FILE *out);
// Evaluates what moves at a moment into `bytes` (size_bytes of them), rounded to float. Refuses what is out of range.
bool frame_uniforms_pack(const struct frame_uniforms *uniforms, const struct frame_moment *moment, void *bytes,
                         struct error *error);
