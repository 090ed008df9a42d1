// SPDX-License-Identifier: Apache-2.0
#include "worker/render/gl_slices.h"

#include "worker/gl/gl_functions.h"
#include "worker/glsl/walk_count.h"

#include <stddef.h>

void gl_slices_finish(struct gl_slices *slices)
{
    if (slices->gl) {
        slices->gl->DeleteTextures(slices->image_count, slices->images);
        slices->gl->DeleteQueries(1, &slices->query);
        slices->gl->DeleteBuffers(1, &slices->count_buffer);
    }
    *slices = (struct gl_slices){0};
}

static void make(struct gl_slices *slices, const struct gl_functions *gl, int width_px, int height_px, int image_count)
{
    gl_slices_finish(slices);
    *slices = (struct gl_slices){.gl = gl, .width_px = width_px, .height_px = height_px, .image_count = image_count};
    gl->CreateTextures(GL_TEXTURE_2D, image_count, slices->images);
    for (int i = 0; i < image_count; ++i)
        gl->TextureStorage2D(slices->images[i], 1, GL_RGBA32UI, width_px, height_px);
    gl->CreateQueries(GL_SAMPLES_PASSED, 1, &slices->query);
    gl->CreateBuffers(1, &slices->count_buffer);
    gl->NamedBufferStorage(slices->count_buffer, 2 * sizeof(GLuint), NULL, 0);
}

void gl_slices_begin(struct gl_slices *slices, const struct gl_functions *gl, int width_px, int height_px,
                     int image_count)
{
    static const GLuint units[GL_SLICES_WALK_IMAGES] = {0, 1, 2, 4, 5}; // 3 is that of lists of pixels
    static const GLuint nothing[4] = {0};

    if (slices->width_px != width_px || slices->height_px != height_px || slices->image_count != image_count)
        make(slices, gl, width_px, height_px, image_count);
    for (int i = 0; i < image_count; ++i) {
        gl->ClearTexImage(slices->images[i], 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, nothing);
        gl->BindImageTexture(units[i], slices->images[i], 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA32UI);
    }
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, WALK_COUNT_BUFFER, slices->count_buffer);
}

void gl_slices_open(const struct gl_slices *slices)
{
    if (slices->image_count == GL_SLICES_WALK_IMAGES)
        slices->gl->ClearNamedBufferData(slices->count_buffer, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
    slices->gl->MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    slices->gl->BeginQuery(GL_SAMPLES_PASSED, slices->query);
}

uint64_t gl_slices_close(const struct gl_slices *slices, struct gl_slices_walked *walked)
{
    const struct gl_functions *gl = slices->gl;
    GLuint64 done = 0;
    GLuint counts[2] = {0};

    gl->EndQuery(GL_SAMPLES_PASSED);
    gl->Finish();
    gl->GetQueryObjectui64v(slices->query, GL_QUERY_RESULT, &done);
    if (slices->image_count == GL_SLICES_WALK_IMAGES) {
        gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        gl->GetNamedBufferSubData(slices->count_buffer, 0, sizeof counts, counts);
    }
    *walked = (struct gl_slices_walked){.steps = (double)WALK_COUNT_STEPS * counts[0],
                                        .pixels = (double)counts[1] / WALK_COUNT_SHARES};
    return done;
}
