// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scatter_seen_glue.h"

#include "worker/glsl/scene_cache.h"
#include "worker/glsl/texture_units.h"
#include "worker/model/scatter_grid.h"
#include "worker/model/scene_model.h"
#include "worker/model/scene_values.h"
#include "worker/scene/scene_inputs.h"
#include "worker/shader/scatter_media_glue.h"

enum { MAJORANT_VOXELS = 4 }; // half the side of bricks of voxels, each with a majorant; they may be turned

// True when none of the majorants' cells lies between points that are half a cell of the grid apart.
static bool skips(const struct scatter_grid *grid)
{
    return !grid->inputs || 0.5 * grid->cell_m < MAJORANT_VOXELS * scene_inputs_find_voxel(grid->inputs);
}

bool scatter_seen_glue_make(struct scene_cache *cache, const struct scatter_grid_program *program,
                            const char *shader_dir, struct error *error)
{
    const struct scatter_grid *grid = program->grid;
    struct shader_assembly text;

    *cache = (struct scene_cache){.name = "scatter_seen",
                                  .unit = TEXTURE_UNIT_SCATTER_SEEN,
                                  .format = SCENE_CACHE_R32F,
                                  .size = {grid->nodes[0], grid->nodes[1], grid->nodes[2]},
                                  .invocations = {grid->nodes[0], grid->nodes[1], grid->nodes[2]},
                                  .sum_count = SCATTER_SEEN_SUMS,
                                  .is_step = true,
                                  .reads = program->reads,
                                  .reads_files = scatter_media_glue_reads_files(program)};
    scene_values_add(&cache->uniforms, program->walked);
    scatter_grid_add_values(&cache->uniforms, grid);
    if (!scene_cache_begin(cache, &text, shader_dir, error)) return false;
    scatter_media_glue_add(&text, program, cache);
    shader_assembly_add(&text, "scatter/turn.glsl");
    shader_assembly_generate(&text);
    fprintf(text.out, "const bool SCATTER_GRID_SKIPS = %s;\n", skips(grid) ? "true" : "false");
    shader_assembly_add(&text, "scatter_grid/seen.glsl");
    shader_assembly_generate(&text);
    fputs("void main()\n{\n", text.out);
    if (cache->uniforms.size_bytes > 0) fputs("    frame_uniforms_read();\n", text.out);
    fputs("    ivec3 at;\n    if (!cache_find_invocation(at)) return;\n"
          "    vec3 cells = vec3(imageSize(cache_image) - 1);\n"
          "    float seen = scatter_seen_of(scatter_grid_low + vec3(at) / cells * scatter_grid_size, "
          "scatter_grid_size / cells);\n"
          "    imageStore(cache_image, at, vec4(seen, 0.0, 0.0, 0.0));\n}\n",
          text.out);
    return scene_cache_end(cache, &text);
}
