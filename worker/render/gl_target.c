// SPDX-License-Identifier: Apache-2.0
#include "worker/render/gl_target.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "worker/gl/gl_functions.h"
#include "worker/picture/image.h"
#include "worker/picture/ray_counts.h"
#include "worker/pixels/pixel_planes.h"
#include "worker/render/pixel_layout.h"

#include <stdlib.h>
#include <string.h>

enum { SIGNATURE = 4, STRIP_ROWS = 16 };

static void attach(struct gl_target *target, int index, GLenum format)
{
    const struct gl_functions *gl = target->gl;

    gl->CreateTextures(GL_TEXTURE_2D, 1, &target->textures[index]);
    gl->TextureStorage2D(target->textures[index], 1, format, target->width_px, target->height_px);
    gl->NamedFramebufferTexture(target->framebuffer, GL_COLOR_ATTACHMENT0 + (GLenum)index, target->textures[index], 0);
}

static bool make_depth_sums(struct gl_target *target, struct error *error)
{
    size_t count = (size_t)target->width_px * (size_t)target->height_px;

    if (!target->has_depth || target->pass_count == 1) return true;
    target->depth_sums = malloc(count * 2 * sizeof *target->depth_sums);
    if (!target->depth_sums)
        error_set(error, "no memory for the depths of %d x %d pixels", target->width_px, target->height_px);
    return target->depth_sums != NULL;
}

static void make_framebuffer(struct gl_target *target)
{
    const GLenum formats[GL_TARGET_TEXTURE_COUNT] = {GL_RGBA32F, target->has_transmittance ? GL_RGBA32F : GL_NONE,
                                                     !target->has_depth   ? GL_NONE
                                                     : target->depth_sums ? GL_RG32F
                                                                          : GL_R32F,
                                                     target->has_paths ? GL_RGBA32F : GL_NONE,
                                                     target->has_signature ? GL_R32UI : GL_NONE};
    GLenum buffers[GL_TARGET_TEXTURE_COUNT];

    target->gl->CreateFramebuffers(1, &target->framebuffer);
    for (int i = 0; i < GL_TARGET_TEXTURE_COUNT; ++i) {
        buffers[i] = formats[i] ? GL_COLOR_ATTACHMENT0 + (GLenum)i : GL_NONE;
        if (formats[i]) attach(target, i, formats[i]);
    }
    target->gl->NamedFramebufferDrawBuffers(target->framebuffer, GL_TARGET_TEXTURE_COUNT, buffers);
}

static struct pixel find_size(const struct gl_target_params *params)
{
    if (params->layout) return (struct pixel){params->layout->width_px, params->layout->height_px};
    return (struct pixel){params->image->width_px, params->image->height_px};
}

bool gl_target_init(struct gl_target *target, const struct gl_functions *gl, const struct gl_target_params *params,
                    struct error *error)
{
    const struct image *image = params->image;
    const struct pixel size = find_size(params);
    GLint side_limit_px = 0;
    GLenum status;

    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &side_limit_px);
    if (size.x > side_limit_px || size.y > side_limit_px) {
        error_set(error, "resolution: expected at most %d x %d here, got %d x %d", side_limit_px, side_limit_px, size.x,
                  size.y);
        return false;
    }
    *target = (struct gl_target){.gl = gl,
                                 .width_px = size.x,
                                 .height_px = size.y,
                                 .pass_count = params->pass_count,
                                 .has_transmittance = image->transmittance != NULL,
                                 .has_depth = image->depth != NULL,
                                 .has_paths = params->has_paths,
                                 .has_signature = params->has_signature};
    if (!make_depth_sums(target, error)) return false;
    make_framebuffer(target);
    status = gl->CheckNamedFramebufferStatus(target->framebuffer, GL_FRAMEBUFFER);
    if (status == GL_FRAMEBUFFER_COMPLETE) return true;
    error_set(error, "GL cannot render into %d x %d float textures (status 0x%04x)", target->width_px,
              target->height_px, status);
    gl_target_finish(target);
    return false;
}

void gl_target_finish(struct gl_target *target)
{
    if (target->gl) {
        target->gl->DeleteFramebuffers(1, &target->framebuffer);
        target->gl->DeleteTextures(GL_TARGET_TEXTURE_COUNT, target->textures);
    }
    free(target->depth_sums);
    *target = (struct gl_target){0};
}

bool gl_target_fits(const struct gl_target *target, const struct gl_target_params *params)
{
    const struct image *image = params->image;
    const struct pixel size = find_size(params);

    return target->gl && target->pass_count == params->pass_count && target->has_paths == params->has_paths &&
           target->has_signature == params->has_signature && target->width_px == size.x &&
           target->height_px == size.y && target->has_transmittance == (image->transmittance != NULL) &&
           target->has_depth == (image->depth != NULL);
}

void gl_target_clear(const struct gl_target *target)
{
    static const float black[4] = {0};

    for (int i = 0; i < GL_TARGET_TEXTURE_COUNT; ++i)
        if (target->textures[i] && i != SIGNATURE)
            target->gl->ClearNamedFramebufferfv(target->framebuffer, GL_COLOR, i, black);
}

void gl_target_begin(const struct gl_target *target)
{
    const struct gl_functions *gl = target->gl;

    gl->BindFramebuffer(GL_DRAW_FRAMEBUFFER, target->framebuffer);
    gl->Viewport(0, 0, target->width_px, target->height_px);
    gl->Disable(GL_SCISSOR_TEST);
    if (target->pass_count == 1) {
        gl->Disable(GL_BLEND);
        return;
    }
    gl->Enable(GL_BLEND);
    gl->BlendFunc(GL_ONE, GL_ONE);
    gl_target_clear(target);
}

static void read_rows(const struct gl_target *target, int index, GLenum format, int first_row, int row_count,
                      float *values)
{
    target->gl->NamedFramebufferReadBuffer(target->framebuffer, GL_COLOR_ATTACHMENT0 + (GLenum)index);
    target->gl->ReadPixels(0, first_row, target->width_px, row_count, format, GL_FLOAT, values);
}

// `size` floats a pixel, in the order of the frame or of the list.
static void read_texture(const struct gl_target *target, const struct pixel_layout *layout, int index, size_t size,
                         float *values)
{
    static const GLenum formats[] = {[1] = GL_RED, [2] = GL_RG, [4] = GL_RGBA};
    float *drawn;

    if (!layout) {
        read_rows(target, index, formats[size], 0, target->height_px, values);
        return;
    }
    drawn = xmalloc(size * (size_t)target->width_px * (size_t)layout->side * sizeof *drawn);
    for (int strip = 0; strip < pixel_layout_strip_count(layout); ++strip) {
        read_rows(target, index, formats[size], pixel_layout_strip_y(strip), layout->side, drawn);
        pixel_layout_gather(layout, strip, drawn, size * sizeof *drawn, values);
    }
    free(drawn);
}

static void keep_cut(const float *paths, size_t count, float *cut)
{
    for (size_t i = 0; i < count; ++i)
        cut[i] = paths[4 * i];
}

// Reads a few rows at a time: nothing keeps them, and all together take as much memory as the picture.
static void count_frame(const struct gl_target *target, float *cut, struct ray_counts *counts)
{
    size_t row_floats = 4 * (size_t)target->width_px;
    float *strip = xmalloc(STRIP_ROWS * row_floats * sizeof *strip);

    for (int y = 0; y < target->height_px; y += STRIP_ROWS) {
        int rows = target->height_px - y < STRIP_ROWS ? target->height_px - y : STRIP_ROWS;

        read_rows(target, 3, GL_RGBA, y, rows, strip);
        for (int i = 0; i < rows; ++i)
            ray_counts_add_row(counts, strip + (size_t)i * row_floats, target->width_px, y + i);
        if (cut) keep_cut(strip, (size_t)rows * (size_t)target->width_px, cut + (size_t)y * (size_t)target->width_px);
    }
    free(strip);
}

static void count_list(const struct gl_target *target, const struct pixel_layout *layout, float *cut,
                       struct ray_counts *counts)
{
    float *paths = xmalloc(4 * layout->count * sizeof *paths);

    read_texture(target, layout, 3, 4, paths);
    for (size_t i = 0; i < layout->count; ++i)
        ray_counts_add_pixel(counts, paths + 4 * i, layout->pixels[i].x, layout->pixels[i].y);
    if (cut) keep_cut(paths, layout->count, cut);
    free(paths);
}

static void divide(float *values, size_t count, int divisor)
{
    for (size_t i = 0; i < count; ++i)
        values[i] /= (float)divisor;
}

static void count_rays(const struct gl_target *target, const struct pixel_layout *layout, float *cut,
                       struct ray_counts *counts)
{
    int64_t pixels = layout ? (int64_t)layout->count : (int64_t)target->width_px * target->height_px;

    *counts = (struct ray_counts){.is_known = true};
    if (layout)
        count_list(target, layout, cut, counts);
    else
        count_frame(target, cut, counts);
    if (cut) divide(cut, (size_t)pixels, target->pass_count);
    ray_counts_find_means(counts, pixels, target->pass_count);
}

static void find_means(const struct gl_target *target, struct image *image)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    const float *sums = target->depth_sums;

    divide(image->rgba, 4 * count, target->pass_count);
    if (image->transmittance) divide(image->transmittance, 4 * count, target->pass_count);
    for (size_t i = 0; image->depth && sums && i < count; ++i)
        image->depth[i] = sums[2 * i + 1] > 0 ? sums[2 * i] / sums[2 * i + 1] : 0;
}

void gl_target_read_rows(const struct gl_target *target, int first_row, int row_count, float *rgba)
{
    target->gl->BindFramebuffer(GL_READ_FRAMEBUFFER, target->framebuffer);
    target->gl->PixelStorei(GL_PACK_ALIGNMENT, 4);
    read_rows(target, 0, GL_RGBA, first_row, row_count, rgba);
}

static void read_picture(const struct gl_target *target, const struct pixel_layout *layout, struct image *image)
{
    target->gl->BindFramebuffer(GL_READ_FRAMEBUFFER, target->framebuffer);
    target->gl->PixelStorei(GL_PACK_ALIGNMENT, 4);
    read_texture(target, layout, 0, 4, image->rgba);
    if (image->transmittance) read_texture(target, layout, 1, 4, image->transmittance);
    if (target->depth_sums)
        read_texture(target, layout, 2, 2, target->depth_sums);
    else if (image->depth)
        read_texture(target, layout, 2, 1, image->depth);
    if (target->pass_count > 1) find_means(target, image);
}

static void read_signatures(const struct gl_target *target, const struct pixel_layout *layout, uint32_t *signatures)
{
    uint32_t *drawn = xmalloc((size_t)target->width_px * (size_t)layout->side * sizeof *drawn);

    target->gl->NamedFramebufferReadBuffer(target->framebuffer, GL_COLOR_ATTACHMENT0 + SIGNATURE);
    for (int strip = 0; strip < pixel_layout_strip_count(layout); ++strip) {
        target->gl->ReadPixels(0, pixel_layout_strip_y(strip), target->width_px, layout->side, GL_RED_INTEGER,
                               GL_UNSIGNED_INT, drawn);
        pixel_layout_gather(layout, strip, drawn, sizeof *drawn, signatures);
    }
    free(drawn);
}

void gl_target_read_planes(const struct gl_target *target, const struct pixel_layout *layout,
                           struct pixel_planes *planes)
{
    struct image list = {.width_px = (int)layout->count,
                         .height_px = 1,
                         .rgba = planes->rgba,
                         .transmittance = planes->transmittance,
                         .depth = planes->depth};

    read_picture(target, layout, &list);
    if (planes->paths) {
        read_texture(target, layout, 3, 4, planes->paths);
        divide(planes->paths, 4 * layout->count, target->pass_count);
    }
    read_signatures(target, layout, planes->signatures);
}

void gl_target_read(const struct gl_target *target, const struct pixel_layout *layout, struct image *image,
                    struct ray_counts *counts)
{
    read_picture(target, layout, image);
    if (target->has_paths)
        count_rays(target, layout, image->cut, counts);
    else if (image->cut)
        memset(image->cut, 0, (size_t)image->width_px * (size_t)image->height_px * sizeof *image->cut);
}
