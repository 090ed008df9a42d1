// The fragment shader of a scene: the modules that it uses, and the glue between them.
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
struct scatter_grid;
struct scene_inputs;

// The zero value is empty.
struct scene_program {
    char *vertex;   // owned
    char *fragment; // owned; `#line` numbers it as shader_assembly.h says, by module_names
    const char *module_names[SHADER_ASSEMBLY_MODULE_LIMIT]; // as shader_assembly.h has them
    size_t module_count;
    char text_hash[HASH_TEXT_SIZE]; // of both texts: those that are equal are linked once
    char hash[HASH_TEXT_SIZE];      // of both texts, and of all that the caches follow from except their uniforms
    // The textures that the fragment shader samples, each after those that it reads itself.
    struct scene_cache caches[SCENE_CACHE_LIMIT];
    size_t cache_count;
    struct light_grid
        *light_grids; // owned; of the visible lights, in order, where they have grids, for the picture or for walks
    size_t light_grid_count;
    struct scatter_grid *scatter_grid; // owned; NULL where there is none
    // Of the walks that fill it: the job as they need it (owned, though all that it refers to is the job's), its model.
    struct job *walked;
    struct scene_model walked_model;
    struct scene_model model;
    struct frame_uniforms uniforms; // refers to the job and the inputs
};

// `job` and `inputs` (the frame's; NULL where the job reads no files) outlive the program. `shader_dir` is as for
// shader_sources_load. A camera without a view is an error.
bool scene_program_init(struct scene_program *program, const struct job *job, const struct scene_inputs *inputs,
                        const char *shader_dir, struct error *error);
// The same, drawing the picture in slices, for a scene whose features allow it: gl_slices.h keeps the pixels' state.
bool scene_program_init_sliced(struct scene_program *program, const struct job *job, const struct scene_inputs *inputs,
                               const char *shader_dir, struct error *error);
void scene_program_finish(struct scene_program *program); // accepts an empty one
