// Checks the text of a scene's shader.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct scene_program;

// Fail the test unless the fragment shader has, or lacks, `text`.
void shader_text_assert_has(const struct scene_program *program, const char *text);
void shader_text_assert_lacks(const struct scene_program *program, const char *text);
// Keeps both shaders in the test's folder (tests/support/temp_folder.h), as number `index`.
void shader_text_keep(void **state, const struct scene_program *program, size_t index);
// Checks all kept shaders with glslangValidator; without it the test is skipped.
void shader_text_assert_valid(void **state);
