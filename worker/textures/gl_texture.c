// SPDX-License-Identifier: Apache-2.0
#include "worker/textures/gl_texture.h"

#include "core/base/error.h"
#include "worker/gl/gl_functions.h"
#include "worker/picture/image.h"

static bool check_size(const struct gl_functions *gl, int width_px, int height_px, struct error *error)
{
    GLint limit = 0;

    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
    if (width_px <= limit && height_px <= limit) return true;
    error_set(error, "GL here takes images of at most %d x %d pixels, got %d x %d", limit, limit, width_px, height_px);
    return false;
}

bool gl_texture_create(const struct gl_functions *gl, int width_px, int height_px, unsigned *texture,
                       struct error *error)
{
    *texture = 0;
    if (!check_size(gl, width_px, height_px, error)) return false;
    gl->CreateTextures(GL_TEXTURE_2D, 1, texture);
    gl->TextureStorage2D(*texture, 1, GL_RGBA32F, width_px, height_px);
    if (gl->GetError() == GL_OUT_OF_MEMORY) {
        error_set(error, "GL here has no room for %d x %d pixels", width_px, height_px);
        gl->DeleteTextures(1, texture);
        *texture = 0;
        return false;
    }
    gl->TextureParameteri(*texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TextureParameteri(*texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return true;
}

void gl_texture_fill(const struct gl_functions *gl, unsigned texture, const struct image *image)
{
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl->TextureSubImage2D(texture, 0, 0, 0, image->width_px, image->height_px, GL_RGBA, GL_FLOAT, image->rgba);
}
