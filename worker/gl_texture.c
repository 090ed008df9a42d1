#include "worker/gl_texture.h"

#include "core/error.h"
#include "worker/gl_functions.h"
#include "worker/image.h"

static bool check_size(const struct gl_functions *gl, const struct image *image, struct error *error)
{
    GLint limit = 0;

    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
    if (image->width_px <= limit && image->height_px <= limit) return true;
    error_set(error, "GL here takes images of at most %d x %d pixels, got %d x %d", limit, limit, image->width_px,
              image->height_px);
    return false;
}

bool gl_texture_create(const struct gl_functions *gl, const struct image *image, unsigned *texture, struct error *error)
{
    *texture = 0;
    if (!check_size(gl, image, error)) return false;
    gl->CreateTextures(GL_TEXTURE_2D, 1, texture);
    gl->TextureStorage2D(*texture, 1, GL_RGBA32F, image->width_px, image->height_px);
    if (gl->GetError() == GL_OUT_OF_MEMORY) {
        error_set(error, "GL here has no room for %d x %d pixels", image->width_px, image->height_px);
        gl->DeleteTextures(1, texture);
        *texture = 0;
        return false;
    }
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl->TextureSubImage2D(*texture, 0, 0, 0, image->width_px, image->height_px, GL_RGBA, GL_FLOAT, image->rgba);
    gl->TextureParameteri(*texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TextureParameteri(*texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return true;
}
