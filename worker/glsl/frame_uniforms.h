// Frame values, the numbers of a shader: constants of the job by name, and what moves, packed for each frame.
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

// The origin of a value.
enum frame_value_origin {
    FRAME_VALUE_OF_TIME, // evaluate()
    FRAME_VALUE_OF_PLAN, // evaluate(), at any time; no motion
    FRAME_VALUE_GIVEN,   // `given`, which follows from a setting likewise
    FRAME_VALUE_FRAME_SEED,
    FRAME_VALUE_SAMPLE_INDEX,
    FRAME_VALUE_STREAM
};

// The moment that one pass over a frame shows.
struct frame_moment {
    double time; // s
    uint32_t frame_seed;
    int sample_index;
    int stream; // of random numbers
};

// Computes a value from `source`, in double precision.
typedef void frame_value_evaluate(const void *source, double time, double value[static 9]);

struct frame_value {
    char name[48];
    enum frame_value_type type;
    enum frame_value_origin origin;
    bool is_constant; // evaluated at time 0, or with seed and index 0
    frame_value_evaluate *evaluate;
    double given[3];
    bool is_position;                      // a point of the world, m: the shader has it relative to the anchor
    frame_value_evaluate *evaluate_linear; // of a shift: the linear map that belongs to it; else NULL
    const void *source;                    // borrowed from the job, which outlives us
    double min, max;                       // range of a component at any time
    const char *meaning;                   // where it is in the job, for messages; borrowed, static
    size_t offset_bytes;                   // in the std140 block, if it moves
};

// The zero value is empty.
struct frame_uniforms {
    const struct job *anchored; // borrowed; points are relative to its anchor (scene_anchor.h); NULL: to the origin
    struct frame_value *values; // owned
    size_t count, capacity;
    size_t size_bytes; // of the block, a multiple of 16; 0 when nothing moves
    size_t end_bytes;  // of the last member that moves
    bool is_shared;    // values that are added move, fixed ones too: the text is that of other numbers as well
};

void frame_uniforms_finish(struct frame_uniforms *uniforms);
// Adds `value` under that name; value.name is ignored.
__attribute__((format(printf, 3, 4))) void frame_uniforms_add(struct frame_uniforms *uniforms, struct frame_value value,
                                                              const char *name_format, ...);
// Writes a `const` for each fixed value. For values that move it writes the block FrameUniforms and variables, which
// `frame_uniforms_read()` sets; main() calls that first. Either way the shader has a value by its name.
void frame_uniforms_declare(const struct frame_uniforms *uniforms, FILE *out);
// Evaluates the moving values at a moment into `bytes` (size_bytes of them), rounded to float. Fails for a value out of
// range.
bool frame_uniforms_pack(const struct frame_uniforms *uniforms, const struct frame_moment *moment, void *bytes,
                         struct error *error);
