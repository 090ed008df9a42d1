// SPDX-License-Identifier: Apache-2.0
#include "worker/render/gl_pixel_list.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/gl/gl_functions.h"
#include "worker/render/pixel_layout.h"

#include <stdint.h>
#include <stdlib.h>

bool gl_pixel_list_check(const struct gl_functions *gl, struct error *error)
{
    GLfloat range[2] = {0};

    gl->GetFloatv(GL_POINT_SIZE_RANGE, range);
    if (range[1] >= PIXEL_LAYOUT_PITCH) return true;
    error_set(error, "GL draws points of at most %g pixels, expected %d", range[1], PIXEL_LAYOUT_PITCH);
    return false;
}

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

// The pixels of a strip. Nothing is drawn beside its squares, nor between strips: what is there does not matter.
static void find_texels(const struct pixel_layout *layout, int strip, uint16_t *texels)
{
    int columns = layout->width_px / PIXEL_LAYOUT_PITCH, end = (strip + 1) * columns;

    for (int square = strip * columns; square < end && square < layout->square_count; square++) {
        int left = pixel_layout_square(layout, square).x;

        for (int i = 0; i < layout->side * layout->side; i++) {
            int x = i % layout->side, y = i / layout->side;
            struct pixel pixel = layout->pixels[pixel_layout_index(layout, square, x, y)];
            uint16_t *texel = texels + 2 * ((size_t)y * (size_t)layout->width_px + (size_t)(left + x));

            texel[0] = (uint16_t)pixel.x;
            texel[1] = (uint16_t)pixel.y;
        }
    }
}

void gl_pixel_list_bind(struct gl_pixel_list *list, const struct gl_functions *gl, const struct pixel_layout *layout)
{
    uint16_t *texels = xcalloc((size_t)layout->width_px * (size_t)layout->side, 2 * sizeof *texels);

    if (list->width_px != layout->width_px || list->height_px != layout->height_px) make(list, gl, layout);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 4);
    for (int strip = 0; strip < pixel_layout_strip_count(layout); strip++) {
        find_texels(layout, strip, texels);
        gl->TextureSubImage2D(list->texture, 0, 0, pixel_layout_strip_y(strip), list->width_px, layout->side,
                              GL_RG_INTEGER, GL_UNSIGNED_SHORT, texels);
    }
    gl->BindImageTexture(GL_PIXEL_LIST_IMAGE_UNIT, list->texture, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RG16UI);
    free(texels);
}

void gl_pixel_list_choose(const struct gl_functions *gl, unsigned program, const struct pixel_layout *layout)
{
    gl->ProgramUniform1i(program, gl->GetUniformLocation(program, "pixel_is_listed"), layout != NULL);
    if (!layout) return;
    gl->ProgramUniform3i(program, gl->GetUniformLocation(program, "list_squares"),
                         layout->width_px / PIXEL_LAYOUT_PITCH, layout->height_px / PIXEL_LAYOUT_PITCH, layout->side);
    gl->Enable(GL_PROGRAM_POINT_SIZE);
}

void gl_pixel_list_draw(const struct gl_functions *gl, int first, int count)
{
    gl->Disable(GL_SCISSOR_TEST);
    gl->DrawArrays(GL_POINTS, first, count);
    gl->Enable(GL_SCISSOR_TEST);
}
