// SPDX-License-Identifier: Apache-2.0
#include "worker/glsl/scene_cache.h"

#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    size_t size_bytes; // of a texel
} formats[] = {
    [SCENE_CACHE_R32F] = {"r32f", 4}, [SCENE_CACHE_RG32F] = {"rg32f", 8}, [SCENE_CACHE_RGBA32F] = {"rgba32f", 16}};

void scene_cache_finish(struct scene_cache *cache)
{
    free(cache->text);
    frame_uniforms_finish(&cache->uniforms);
    *cache = (struct scene_cache){0};
}

void scene_cache_hash(const struct scene_cache *cache, char hash[static HASH_TEXT_SIZE])
{
    char text[HASH_TEXT_SIZE + 160];

    snprintf(text, sizeof text, "%s format %s size %d %d %d invocations %d %d %d", cache->hash,
             formats[cache->format].name, cache->size[0], cache->size[1], cache->size[2], cache->invocations[0],
             cache->invocations[1], cache->invocations[2]);
    hash_bytes(text, strlen(text), hash);
}

size_t scene_cache_size_bytes(const struct scene_cache *cache)
{
    return (size_t)cache->size[0] * (size_t)cache->size[1] * (size_t)cache->size[2] *
               formats[cache->format].size_bytes +
           (cache->reads_sums ? 0 : cache->sum_count * sizeof(uint32_t));
}

bool scene_cache_begin(struct scene_cache *cache, struct shader_assembly *text, const char *shader_dir,
                       struct error *error)
{
    if (!shader_assembly_begin(text, shader_dir, error)) {
        scene_cache_finish(cache);
        return false;
    }
    fprintf(text->out,
            "#version 450 core\n"
            "layout(local_size_x = %d, local_size_y = %d) in;\n"
            "layout(%s, binding = 0) %suniform image3D cache_image;\n"
            "layout(location = 0) uniform ivec3 cache_first;\n"
            "layout(location = 1) uniform ivec3 cache_invocations;\n"
            "bool cache_find_invocation(out ivec3 at)\n{\n"
            "    at = cache_first + ivec3(gl_GlobalInvocationID);\n"
            "    return all(lessThan(at, cache_invocations));\n}\n",
            SCENE_CACHE_GROUP_SIDE, SCENE_CACHE_GROUP_SIDE, formats[cache->format].name,
            cache->takes_turns ? "" : "writeonly ");
    if (cache->part_count > 0)
        fputs("layout(std430, binding = 0) buffer CacheParts { uint cache_next, cache_left; };\n"
              "uint cache_take()\n{\n    return atomicAdd(cache_next, 1u);\n}\n"
              "void cache_leave(uint number)\n{\n    atomicMin(cache_left, number);\n}\n",
              text->out);
    else if (cache->takes_turns)
        fputs("layout(std430, binding = 0) buffer CacheTurns { uint cache_is_unfinished; };\n", text->out);
    if (cache->sum_count > 0 || cache->reads_sums)
        fprintf(text->out, "layout(std430, binding = 1) %sbuffer CacheSums { uint cache_sums[]; };\n",
                cache->sum_count == 0 ? "readonly " : "");
    return true;
}

bool scene_cache_end(struct scene_cache *cache, struct shader_assembly *text)
{
    memcpy(cache->module_names, text->module_names, sizeof cache->module_names);
    cache->module_count = text->module_count;
    cache->text = shader_assembly_end(text);
    if (cache->text)
        hash_bytes(cache->text, strlen(cache->text), cache->hash);
    else
        scene_cache_finish(cache);
    return cache->text != NULL;
}
