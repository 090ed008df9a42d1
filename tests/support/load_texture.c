// SPDX-License-Identifier: Apache-2.0
#include "tests/support/load_texture.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/job.h"
#include "reference/still.h"
#include "worker/picture/image.h"
#include "worker/scene/texture_image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static void load(struct still_texture *texture, const struct scene_texture *source)
{
    struct error error = {{0}};
    struct image image;
    size_t count;
    float *rgb;

    if (!texture_image_load(&image, source, &error)) fail_msg("%s", error.message);
    count = (size_t)image.width_px * (size_t)image.height_px;
    rgb = xcalloc(3 * count, sizeof *rgb);
    for (size_t i = 0; i < 3 * count; ++i)
        rgb[i] = image.rgba[i / 3 * 4 + i % 3];
    *texture = (struct still_texture){rgb, image.width_px, image.height_px};
    image_finish(&image);
}

void load_texture_inputs(struct still_inputs *inputs, const struct job *job)
{
    for (size_t i = 0; i < job->scene.object_count; ++i) {
        inputs->textures[i] = (struct still_texture){0};
        if (job->scene.objects[i].material.texture.file)
            load(&inputs->textures[i], &job->scene.objects[i].material.texture);
    }
    inputs->dome = (struct still_texture){0};
    for (size_t i = 0; i < job->scene.light_count; ++i)
        if (job->scene.lights[i].dome.image.file) load(&inputs->dome, &job->scene.lights[i].dome.image);
}

void load_texture_finish(struct still_inputs *inputs)
{
    for (size_t i = 0; i < SCENE_OBJECT_LIMIT; ++i)
        free((void *)(uintptr_t)inputs->textures[i].rgb);
    free((void *)(uintptr_t)inputs->dome.rgb);
}
