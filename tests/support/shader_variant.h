// Copies of shader modules that differ from them in one place.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Writes the module `name` ("scatter/walk.glsl") into the test's temporary folder (temp_folder.h), which may then be a
// shader_dir, with `to` in place of the first `from`, which must be there.
void shader_variant_write(void **state, const char *name, const char *from, const char *to);
