// A renderer in software that keeps tolerances, opened by a test.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/gl_stage.h"
#include "worker/plan/tolerance.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct image;
struct job;

struct tolerance_stage {
    struct gl_stage gl;
    struct tolerance *tolerance;
};

// `shader_dir` as renderer_create has it. Fails the test where there is no GL in software.
struct tolerance_stage tolerance_stage_open(const char *shader_dir);
void tolerance_stage_close(struct tolerance_stage stage);
struct image tolerance_stage_make_image(const struct job *job); // of the job's size and channels; owned
// Makes the image too, which is the caller's whatever becomes of it. Otherwise as tolerance_render, with serial 1.
bool tolerance_stage_render(struct tolerance_stage stage, const struct job *job, int32_t frame, struct image *image,
                            struct tolerance_result *result, struct error *error);
