// SPDX-License-Identifier: Apache-2.0
#include "tests/support/tolerance_stage.h"

#include "core/base/error.h"
#include "core/job/job.h"
#include "worker/picture/image.h"
#include "worker/render/renderer.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

struct tolerance_stage tolerance_stage_open(const char *shader_dir)
{
    struct tolerance_stage stage = {.gl = gl_stage_open(GL_BACKEND_SOFTWARE, shader_dir)};

    stage.tolerance = tolerance_create(stage.gl.renderer);
    return stage;
}

void tolerance_stage_close(struct tolerance_stage stage)
{
    tolerance_destroy(stage.tolerance);
    gl_stage_close(stage.gl);
}

struct image tolerance_stage_make_image(const struct job *job)
{
    struct image image;

    assert_true(
        image_init(&image, job->width_px, job->height_px, job->output.has_depth, job->output.has_transmittance, NULL));
    return image;
}

bool tolerance_stage_render(struct tolerance_stage stage, const struct job *job, int32_t frame, struct image *image,
                            struct tolerance_result *result, struct error *error)
{
    *image = tolerance_stage_make_image(job);
    return tolerance_render(stage.tolerance,
                            &(struct tolerance_params){.job = job, .serial = 1, .frame = frame, .image = image}, result,
                            error);
}
