// SPDX-License-Identifier: Apache-2.0
#include "worker/render/passes.h"

#include "core/base/alloc.h"
#include "core/job/job.h"
#include "worker/scene/pixel_samples.h"
#include "worker/shader/scene_program.h"

#include <stdlib.h>
#include <string.h>

static size_t count_bytes(const struct scene_program *scene)
{
    size_t bytes = scene->uniforms.size_bytes;

    for (size_t i = 0; i < scene->cache_count; ++i)
        bytes += scene->caches[i].uniforms.size_bytes;
    return bytes;
}

static bool pack(const struct scene_program *scene, const struct frame_moment *moment, unsigned char *block,
                 struct error *error)
{
    if (!frame_uniforms_pack(&scene->uniforms, moment, block, error)) return false;
    block += scene->uniforms.size_bytes;
    for (size_t i = 0; i < scene->cache_count; ++i) {
        const struct frame_uniforms *uniforms = &scene->caches[i].uniforms;

        if (!frame_uniforms_pack(uniforms, moment, block, error)) return false;
        block += uniforms->size_bytes;
    }
    return true;
}

bool passes_plan(struct passes *passes, const struct passes_params *params, struct error *error)
{
    const struct scene_program *scene = params->scene;
    const struct job *job = params->job;
    size_t block_bytes = count_bytes(scene);
    bool differ = false;

    *passes = (struct passes){.block_bytes = block_bytes, .count = pixel_samples_count(job)};
    passes->are_still = scene_is_constant(&job->scene) || job->scene.camera.shutter == 0.0;
    passes->blocks = xmalloc(((size_t)passes->count + 1) * block_bytes);
    for (int i = 0; i <= passes->count; ++i) {
        const struct frame_moment moment = {.time = pixel_samples_time(job, params->frame, i),
                                            .frame_seed = pixel_samples_frame_seed(job, params->frame),
                                            .sample_index = i,
                                            .stream = params->stream};
        unsigned char *block = passes->blocks + (size_t)i * block_bytes;

        if (!pack(scene, &moment, block, error)) return false;
        if (i < passes->count && memcmp(block, passes->blocks, block_bytes) != 0) differ = true;
    }
    if (!differ) passes->count = 1;
    return true;
}

void passes_finish(struct passes *passes)
{
    free(passes->blocks);
    *passes = (struct passes){0};
}

struct passes passes_centre(const struct passes *passes)
{
    return (struct passes){.blocks = passes->blocks + (size_t)passes->count * passes->block_bytes,
                           .block_bytes = passes->block_bytes,
                           .count = 1,
                           .are_still = true};
}

const unsigned char *passes_block(const struct passes *passes, int pass)
{
    return passes->blocks + (size_t)pass * passes->block_bytes;
}

void passes_cache_blocks(const struct passes *passes, const struct scene_program *scene, int pass,
                         const unsigned char **blocks)
{
    const unsigned char *block = passes_block(passes, pass) + scene->uniforms.size_bytes;

    for (size_t i = 0; i < scene->cache_count; ++i) {
        blocks[i] = block;
        block += scene->caches[i].uniforms.size_bytes;
    }
}

bool passes_are_equal(const struct passes *a, const struct passes *b)
{
    return a->count == b->count && a->block_bytes == b->block_bytes &&
           memcmp(a->blocks, b->blocks, (size_t)a->count * a->block_bytes) == 0;
}
