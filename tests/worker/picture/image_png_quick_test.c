// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_png_quick.h"

#include "core/base/alloc.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/picture/image_png_read.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

#include <cmocka.h>

// libpng checks the checksums of what it reads. Noise cannot be packed.
static void assert_reads_back(const char *path, int width_px, int height_px, bool is_noise)
{
    size_t count = 3 * (size_t)width_px * (size_t)height_px;
    unsigned char *rgb = xmalloc(count);
    struct image image;
    uint32_t random = 1;
    int fd;

    for (size_t i = 0; i < count; i++) {
        random = random * 1664525u + 1013904223u;
        rgb[i] = is_noise ? (unsigned char)(random >> 24) : (unsigned char)(i % 3 * 90);
    }
    assert_true(image_png_quick_write(path, rgb, width_px, height_px, NULL));
    fd = open(path, O_RDONLY);
    assert_true(fd >= 0);
    assert_true(image_png_read(fd, true, &image, NULL, NULL));
    close(fd);
    assert_int_equal(image.width_px, width_px);
    assert_int_equal(image.height_px, height_px);
    for (size_t i = 0; i < count; i++)
        assert_float_equal(255.0 * (double)image.rgba[i / 3 * 4 + i % 3], rgb[i], 1e-3);
    image_finish(&image);
    free(rgb);
}

static void what_is_written_is_read_back(void **state)
{
    const char *path = temp_folder_path(state, "quick.png");

    assert_reads_back(path, 1, 1, true);
    assert_reads_back(path, 641, 7, false);
    assert_reads_back(path, 643, 357, true);
    assert_reads_back(path, 1920, 1080, false);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_is_written_is_read_back, temp_folder_create, temp_folder_destroy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
