// SPDX-License-Identifier: Apache-2.0
#include "tests/support/exr_maker.h"

#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <unistd.h>

#include <cmocka.h>

void exr_maker_write(const char *path, int width, int height, enum job_pixel pixel, const float *rgb)
{
    const struct image_exr_header header = {.pixel = pixel,
                                            .compression = JOB_COMPRESSION_ZIP,
                                            .fps_numerator = 24,
                                            .fps_denominator = 1,
                                            .owner = "",
                                            .job_hash = "",
                                            .method = "",
                                            .backend = "",
                                            .renderer = "",
                                            .shader_hash = ""};
    int fd = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    struct error error = {{0}};
    struct image image;

    assert_true(fd >= 0 && image_init(&image, width, height, false, false, NULL));
    for (size_t i = 0; i < (size_t)width * (size_t)height * 4; i++)
        image.rgba[i] = i % 4 == 3 ? 1.0f : rgb[i / 4 * 3 + i % 4];
    if (!image_exr_write(fd, &image, &header, 1, &error)) fail_msg("%s", error.message);
    image_finish(&image);
    close(fd);
}
