// SPDX-License-Identifier: Apache-2.0
#include "worker/render/gl_pixel_list.h"

#include "core/base/alloc.h"
#include "worker/gl/gl_functions.h"
#include "worker/render/pixel_layout.h"

#include <stdint.h>
#include <stdlib.h>

void gl_pixel_list_finish(struct gl_pixel_list *list)
{
    if (list->texture) list->gl->DeleteTextures(1, &list->texture);
    *list = (struct gl_pixel_list){0};
}

static void make(struct gl_pixel_list *list, const struct gl_functions *gl, const struct pixel_layout *layout)
{
    gl_pixel_list_finish(list);
    *list = (struct gl_pixel_list){.gl = gl, .width_px = layout->width_px, .height_px = layout->height_px};
    gl->CreateTextures(GL_TEXTURE_2D, 1, &list->texture);
    gl->TextureStorage2D(list->texture, 1, GL_RG16UI, list->width_px, list->height_px);
}

// Places outside the squares keep pixel (0, 0): nothing is drawn there.
static uint16_t *find_texels(const struct pixel_layout *layout)
{
    uint16_t *texels = xcalloc((size_t)layout->width_px * (size_t)layout->height_px, 2 * sizeof *texels);

    for (int square = 0; square < layout->square_count; square++) {
        struct pixel corner = pixel_layout_square(layout, square);

        for (int i = 0; i < layout->side * layout->side; i++) {
            int x = i % layout->side, y = i / layout->side;
            struct pixel pixel = layout->pixels[pixel_layout_index(layout, square, x, y)];
            uint16_t *texel = texels + 2 * ((size_t)(corner.y + y) * (size_t)layout->width_px + (size_t)(corner.x + x));

            texel[0] = (uint16_t)pixel.x;
            texel[1] = (uint16_t)pixel.y;
        }
    }
    return texels;
}

void gl_pixel_list_bind(struct gl_pixel_list *list, const struct gl_functions *gl, const struct pixel_layout *layout)
{
    uint16_t *texels = find_texels(layout);

    if (list->width_px != layout->width_px || list->height_px != layout->height_px) make(list, gl, layout);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    gl->TextureSubImage2D(list->texture, 0, 0, 0, list->width_px, list->height_px, GL_RG_INTEGER, GL_UNSIGNED_SHORT,
                          texels);
    gl->BindImageTexture(GL_PIXEL_LIST_IMAGE_UNIT, list->texture, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RG16UI);
    free(texels);
}

void gl_pixel_list_choose(const struct gl_functions *gl, unsigned program, bool is_listed)
{
    gl->ProgramUniform1i(program, gl->GetUniformLocation(program, "pixel_is_listed"), is_listed);
}
