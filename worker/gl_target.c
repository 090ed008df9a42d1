#include "worker/gl_target.h"

#include "core/error.h"
#include "worker/gl_functions.h"
#include "worker/image.h"

#include <stdlib.h>

static void attach(struct gl_target *target, int index, GLenum format)
{
    const struct gl_functions *gl = target->gl;

    gl->CreateTextures(GL_TEXTURE_2D, 1, &target->textures[index]);
    gl->TextureStorage2D(target->textures[index], 1, format, target->width_px, target->height_px);
    gl->NamedFramebufferTexture(target->framebuffer, GL_COLOR_ATTACHMENT0 + (GLenum)index, target->textures[index], 0);
}

bool gl_target_init(struct gl_target *target, const struct gl_functions *gl, const struct image *image, int pass_count,
                    struct error *error)
{
    GLenum buffers[3] = {GL_COLOR_ATTACHMENT0, GL_NONE, GL_NONE};
    GLint side_limit_px = 0;
    GLenum status;

    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &side_limit_px);
    if (image->width_px > side_limit_px || image->height_px > side_limit_px) {
        error_set(error, "resolution: expected at most %d x %d here, got %d x %d", side_limit_px, side_limit_px,
                  image->width_px, image->height_px);
        return false;
    }
    *target = (struct gl_target){.gl = gl,
                                 .width_px = image->width_px,
                                 .height_px = image->height_px,
                                 .pass_count = pass_count,
                                 .has_transmittance = image->transmittance != NULL,
                                 .has_depth = image->depth != NULL};
    if (target->has_depth && pass_count > 1) {
        target->depth_sums =
            malloc((size_t)image->width_px * (size_t)image->height_px * 2 * sizeof *target->depth_sums);
        if (!target->depth_sums) {
            error_set(error, "no memory for the depths of %d x %d pixels", image->width_px, image->height_px);
            return false;
        }
    }
    gl->CreateFramebuffers(1, &target->framebuffer);
    attach(target, 0, GL_RGBA32F);
    if (target->has_transmittance) attach(target, 1, GL_RGBA32F);
    if (target->has_depth) attach(target, 2, target->depth_sums ? GL_RG32F : GL_R32F);
    if (target->has_transmittance) buffers[1] = GL_COLOR_ATTACHMENT1;
    if (target->has_depth) buffers[2] = GL_COLOR_ATTACHMENT2;
    gl->NamedFramebufferDrawBuffers(target->framebuffer, 3, buffers);
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
        target->gl->DeleteTextures(3, target->textures);
    }
    free(target->depth_sums);
    *target = (struct gl_target){0};
}

bool gl_target_fits(const struct gl_target *target, const struct image *image, int pass_count)
{
    return target->gl && target->pass_count == pass_count && target->width_px == image->width_px &&
           target->height_px == image->height_px && target->has_transmittance == (image->transmittance != NULL) &&
           target->has_depth == (image->depth != NULL);
}

void gl_target_begin(const struct gl_target *target)
{
    static const float black[4] = {0};
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
    for (int i = 0; i < 3; ++i)
        if (target->textures[i]) gl->ClearNamedFramebufferfv(target->framebuffer, GL_COLOR, i, black);
}

static void read_texture(const struct gl_target *target, int index, GLenum format, float *pixels)
{
    target->gl->NamedFramebufferReadBuffer(target->framebuffer, GL_COLOR_ATTACHMENT0 + (GLenum)index);
    target->gl->ReadPixels(0, 0, target->width_px, target->height_px, format, GL_FLOAT, pixels);
}

static void divide(float *values, size_t count, int divisor)
{
    for (size_t i = 0; i < count; ++i)
        values[i] /= (float)divisor;
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

void gl_target_read(const struct gl_target *target, struct image *image)
{
    target->gl->BindFramebuffer(GL_READ_FRAMEBUFFER, target->framebuffer);
    target->gl->PixelStorei(GL_PACK_ALIGNMENT, 4);
    read_texture(target, 0, GL_RGBA, image->rgba);
    if (image->transmittance) read_texture(target, 1, GL_RGBA, image->transmittance);
    if (target->depth_sums)
        read_texture(target, 2, GL_RG, target->depth_sums);
    else if (image->depth)
        read_texture(target, 2, GL_RED, image->depth);
    if (target->pass_count > 1) find_means(target, image);
}
