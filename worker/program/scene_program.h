// The fragment shader of a scene, assembled from the modules it uses and generated glue between them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "worker/glsl/frame_uniforms.h"
#include "worker/glsl/scene_cache.h"
#include "worker/glsl/shader_assembly.h"
#include "worker/model/scene_model.h"

#include <stdbool.h>
#include <stddef.h>

struct error;
struct job;
struct light_grid;
struct scene_inputs;

// The zero value is empty.
struct scene_program {
    char *vertex;   // owned
    char *fragment; // owned; `#line` numbers it as shader_assembly.h says, by module_names
    const char *module_names[SHADER_ASSEMBLY_MODULE_LIMIT]; // as shader_assembly.h has them
    size_t module_count;
    char hash[HASH_TEXT_SIZE]; // of both texts, and of all that the caches follow from but for their uniforms
    // What the fragment shader samples, each after those that it reads itself.
    struct scene_cache caches[SCENE_CACHE_LIMIT];
    size_t cache_count;
    struct light_grid *light_grids; // owned; of each light that is seen, in order, where they have grids
    size_t light_grid_count;
    struct scene_model model;
    struct frame_uniforms uniforms; // refers to the job and the inputs
};

// `job` and `inputs`, the frame's, outlive the program; NULL will do for a job that reads no files. `shader_dir` is as for shader_sources_load. A camera that cannot look is an error.
bool scene_program_init(struct scene_program *program, const struct job *job, const struct scene_inputs *inputs,
                        const char *shader_dir, struct error *error);
// One that draws the picture in slices, of a scene whose features allow it: gl_slices.h keeps what pixels have.
bool scene_program_init_sliced(struct scene_program *program, const struct job *job, const struct scene_inputs *inputs,
                               const char *shader_dir, struct error *error);
void scene_program_finish(struct scene_program *program); // accepts an empty one
