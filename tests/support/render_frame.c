// SPDX-License-Identifier: Apache-2.0
#include "tests/support/render_frame.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "tests/support/gl_stage.h"
#include "tests/support/shader_dir.h"
#include "worker/picture/image.h"
#include "worker/picture/ray_counts.h"
#include "worker/render/renderer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

void render_frame_counting_rays(enum gl_backend backend, const struct job *job, struct image *image,
                                struct ray_counts *counts)
{
    struct error error = {{0}};
    struct gl_stage stage = gl_stage_open(backend, test_shader_dir());
    struct renderer_result result;

    if (!image_init(image, job->width_px, job->height_px, true, true, &error) ||
        !renderer_render(stage.renderer, &(struct renderer_frame){.job = job, .frame = 0, .image = image}, &result,
                         &error)) {
        fail_msg("%s", error.message);
    }
    *counts = result.ray_counts;
    gl_stage_close(stage);
}

void render_frame_on(enum gl_backend backend, const struct job *job, struct image *image)
{
    struct ray_counts counts;

    render_frame_counting_rays(backend, job, image, &counts);
}

void render_frame_zero(const struct job *job, struct image *image)
{
    render_frame_on(GL_BACKEND_SOFTWARE, job, image);
}
