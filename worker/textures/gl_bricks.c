// SPDX-License-Identifier: Apache-2.0
#include "worker/textures/gl_bricks.h"

#include "core/base/error.h"
#include "worker/gl/gl_functions.h"

static void set_nearest(const struct gl_functions *gl, unsigned texture)
{
    gl->TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

// Returns a side of at least `count` texels that is no power of two. Software GL compiles a program again for textures
// with such sides, and in a sequence of grids only some would have them.
static GLsizei side_of(int count)
{
    while ((count & (count - 1)) == 0)
        ++count;
    return count;
}

static bool check_size(const struct gl_functions *gl, const struct brick_atlas *atlas, struct error *error)
{
    GLint side_limit = 0, layer_limit = 0;
    const int *texels = atlas->texels;

    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &side_limit);
    gl->GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layer_limit);
    if (texels[0] <= side_limit && texels[1] <= side_limit && texels[2] <= layer_limit) return true;
    error_set(error, "GL here takes textures of at most %d x %d x %d texels, its bricks need %d x %d x %d", side_limit,
              side_limit, layer_limit, texels[0], texels[1], texels[2]);
    return false;
}

bool gl_bricks_init(struct gl_bricks *bricks, const struct gl_functions *gl, const struct brick_atlas *atlas,
                    struct error *error)
{
    const int *texels = atlas->texels, *count = atlas->brick_count;

    *bricks = (struct gl_bricks){.gl = gl};
    if (!check_size(gl, atlas, error)) return false;
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->CreateTextures(GL_TEXTURE_3D, 1, &bricks->index);
    gl->TextureStorage3D(bricks->index, 1, GL_RGBA16UI, side_of(count[0]), side_of(count[1]), side_of(count[2]));
    gl->TextureSubImage3D(bricks->index, 0, 0, 0, 0, count[0], count[1], count[2], GL_RGBA_INTEGER, GL_UNSIGNED_SHORT,
                          atlas->index);
    set_nearest(gl, bricks->index);
    for (int i = 0; i < BRICK_ATLAS_GRIDS; ++i) {
        if (!atlas->values[i]) continue;
        gl->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &bricks->values[i]);
        gl->TextureStorage3D(bricks->values[i], 1, GL_R32F, texels[0], texels[1], texels[2]);
        if (gl->GetError() == GL_OUT_OF_MEMORY) {
            error_set(error, "GL has no memory for %d x %d x %d texels", texels[0], texels[1], texels[2]);
            gl_bricks_finish(bricks);
            return false;
        }
        gl->TextureSubImage3D(bricks->values[i], 0, 0, 0, 0, texels[0], texels[1], texels[2], GL_RED, GL_FLOAT,
                              atlas->values[i]);
        set_nearest(gl, bricks->values[i]);
    }
    return true;
}

void gl_bricks_finish(struct gl_bricks *bricks)
{
    if (bricks->index) bricks->gl->DeleteTextures(1, &bricks->index);
    for (int i = 0; i < BRICK_ATLAS_GRIDS; ++i)
        if (bricks->values[i]) bricks->gl->DeleteTextures(1, &bricks->values[i]);
    *bricks = (struct gl_bricks){0};
}
