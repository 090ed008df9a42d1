// SPDX-License-Identifier: Apache-2.0
#include "worker/shader/scatter_media_glue.h"

#include "worker/glsl/scene_cache.h"
#include "worker/model/scene_model.h"
#include "worker/scene/scene_inputs.h"
#include "worker/shader/scene_glue_media.h"
#include "worker/shader/scene_glue_tracking.h"
#include "worker/shader/scene_modules.h"

static void add_densities(struct shader_assembly *text, const struct scene_model *walked)
{
    for (size_t i = 0; i < walked->features.medium_count; ++i)
        if (walked->features.media[i].is_seen) scene_modules_add_density(text, walked, i);
}

void scatter_media_glue_add(struct shader_assembly *text, const struct scatter_grid_program *program,
                            const struct scene_cache *cache)
{
    const struct scene_model *walked = program->walked;

    shader_assembly_add(text, "math/constants.glsl");
    shader_assembly_add(text, walked->features.is_rgb ? "math/spectrum_rgb.glsl" : "math/spectrum_grey.glsl");
    shader_assembly_generate(text);
    frame_uniforms_declare(&cache->uniforms, text->out);
    shader_assembly_add(text, "math/march.glsl");
    shader_assembly_add(text, "math/random.glsl");
    shader_assembly_add(text, "scatter/random.glsl");
    shader_assembly_add(text, "region/span.glsl");
    add_densities(text, walked);
    shader_assembly_generate(text);
    scene_glue_write_media(text->out, walked);
    shader_assembly_add(text, "math/tracking.glsl");
    shader_assembly_generate(text);
    scene_glue_write_tracking(text->out, walked);
}

bool scatter_media_glue_reads_files(const struct scatter_grid_program *program)
{
    const struct scene_model *walked = program->walked;
    bool reads_files = false;

    for (size_t i = 0; i < walked->features.medium_count; ++i)
        reads_files |= walked->features.media[i].is_seen && walked->inputs && walked->inputs->media[i].source;
    return reads_files;
}
