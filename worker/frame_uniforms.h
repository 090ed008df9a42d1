// The numbers of a shader: constants of the job by name, and what moves, packed for each frame.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct error;

enum frame_value_type {
    FRAME_VALUE_FLOAT,
    FRAME_VALUE_VEC3,
    FRAME_VALUE_MAT3 // column-major
};

// Computes a value from what describes it, in double precision.
typedef void frame_value_evaluate(const void *source, double time, double value[static 9]);

struct frame_value {
    char name[48];
    enum frame_value_type type;
    bool is_constant;
    frame_value_evaluate *evaluate;
    const void *source;  // borrowed from the job, which outlives us
    double min, max;     // what a component may be at any time
    const char *meaning; // the place in the job, for messages; borrowed, static
    size_t offset_bytes; // of what moves, in the std140 block
};

// The zero value is empty.
struct frame_uniforms {
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
// Evaluates what moves at `time` into `bytes` (size_bytes of them), rounded to float. Refuses what is out of range.
bool frame_uniforms_pack(const struct frame_uniforms *uniforms, double time, void *bytes, struct error *error);
