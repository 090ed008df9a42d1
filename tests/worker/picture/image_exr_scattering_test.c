// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr.h"

#include "core/base/error.h"
#include "worker/picture/image.h"

#include <OpenEXR/openexr.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

static int write_image(int orders, double paths)
{
    const struct image_exr_header header = {.pixel = JOB_PIXEL_HALF,
                                            .compression = JOB_COMPRESSION_ZIP,
                                            .fps_numerator = 24,
                                            .fps_denominator = 1,
                                            .method = "paths",
                                            .orders = orders,
                                            .paths = paths};
    int fd = memfd_create("frame", MFD_CLOEXEC);
    struct error error = {{0}};
    struct image image;

    assert_true(fd >= 0 && image_init(&image, 2, 2, false, false, NULL));
    memset(image.rgba, 0, 16 * sizeof *image.rgba);
    if (!image_exr_write(fd, &image, &header, 1, &error)) fail_msg("%s", error.message);
    image_finish(&image);
    return fd;
}

// NULL: the header says nothing.
static void assert_told(int orders, const char *expected)
{
    int fd = write_image(orders, 0);
    const exr_attribute_t *found = NULL;
    exr_context_t context;
    char path[64];

    snprintf(path, sizeof path, "/proc/%d/fd/%d", (int)getpid(), fd);
    assert_int_equal(exr_start_read(&context, path, NULL), EXR_ERR_SUCCESS);
    assert_int_equal(exr_get_attribute_by_name(context, 0, "marchd:scattering", &found) == EXR_ERR_SUCCESS, !!expected);
    if (expected) {
        assert_int_equal(found->type, EXR_ATTR_STRING);
        assert_string_equal(found->string->str, expected);
    }
    exr_finish(&context);
    close(fd);
}

static void orders_of_scattering_are_told_above_one(void **state)
{
    assert_told(0, NULL);
    assert_told(1, NULL);
    assert_told(2, "2");
    assert_told(SCENE_ORDER_LIMIT, "1000");
    assert_told(SCENE_ORDERS_ALL, "all");
}

static void paths_are_counted_where_there_are_some(void **state)
{
    static const double counts[] = {0, 1, 0x1p32};

    (void)state;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        int fd = write_image(2, counts[i]);
        const exr_attribute_t *found = NULL;
        exr_context_t context;
        char path[64];

        snprintf(path, sizeof path, "/proc/%d/fd/%d", (int)getpid(), fd);
        assert_int_equal(exr_start_read(&context, path, NULL), EXR_ERR_SUCCESS);
        assert_int_equal(exr_get_attribute_by_name(context, 0, "marchd:paths", &found) == EXR_ERR_SUCCESS, i > 0);
        if (i > 0) assert_true(found->type == EXR_ATTR_DOUBLE && found->d == counts[i]);
        exr_finish(&context);
        close(fd);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(paths_are_counted_where_there_are_some),
        cmocka_unit_test(orders_of_scattering_are_told_above_one),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
