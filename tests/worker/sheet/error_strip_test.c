// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/error_strip.h"

#include "core/base/error.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/picture/image_png_read.h"

#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <unistd.h>

#include <cmocka.h>

enum { WIDTH = 40, HEIGHT = 20, GAP = 4 };

static void fill(struct image *image, float value)
{
    assert_true(image_init(image, WIDTH, HEIGHT, false, false, NULL));
    for (int i = 0; i < 4 * WIDTH * HEIGHT; i++)
        image->rgba[i] = value;
}

static void set(struct image *image, int x, int y, float value)
{
    for (int c = 0; c < 3; c++)
        image->rgba[4 * (y * WIDTH + x) + c] = value;
}

static const float *at(const struct image *sheet, int x, int y)
{
    return &sheet->rgba[4 * (y * sheet->width_px + x)];
}

static void read_sheet(const char *path, struct image *sheet)
{
    int fd = open(path, O_RDONLY);

    assert_true(fd >= 0);
    assert_true(image_png_read(fd, true, sheet, NULL, NULL));
    close(fd);
}

static void map_tells_too_bright_from_too_dark(void **state)
{
    const char *path = temp_folder_path(state, "strip.png");
    struct image picture, truth, sheet;
    struct error_strip_result result;
    const float *color;

    fill(&picture, 1.0f);
    fill(&truth, 1.0f);
    set(&picture, 10, 5, 1.1f);
    set(&picture, 30, 5, 0.9f);
    assert_true(error_strip_write(
        &(struct error_strip_params){
            .pictures = &(struct error_strip_picture){&picture, "a"}, .count = 1, .truth = {&truth, "b"}, .out = path},
        &result, NULL));
    read_sheet(path, &sheet);
    assert_int_equal(sheet.width_px, result.width_px);
    assert_int_equal(sheet.height_px, result.height_px);
    assert_int_equal(result.width_px, 4 * WIDTH + 3 * GAP);
    assert_float_equal(result.scale, 0.1, 1e-6);
    color = at(&sheet, WIDTH + GAP + 10, 5);
    assert_true(color[0] > 0.9f && color[2] < 0.5f);
    color = at(&sheet, WIDTH + GAP + 30, 5);
    assert_true(color[2] > 0.9f && color[0] < 0.5f);
    color = at(&sheet, WIDTH + GAP + 20, 5);
    assert_true(color[0] == 0.0f && color[1] == 0.0f && color[2] == 0.0f);
    image_finish(&picture);
    image_finish(&truth);
    image_finish(&sheet);
}

static void what_is_no_number_is_white(void **state)
{
    const char *path = temp_folder_path(state, "strip.png");
    struct image picture, truth, sheet;
    struct error_strip_result result;

    fill(&picture, 1.0f);
    fill(&truth, 1.0f);
    set(&picture, 10, 5, NAN);
    assert_true(error_strip_write(
        &(struct error_strip_params){
            .pictures = &(struct error_strip_picture){&picture, "a"}, .count = 1, .truth = {&truth, "b"}, .out = path},
        &result, NULL));
    read_sheet(path, &sheet);
    for (int c = 0; c < 3; c++)
        assert_float_equal(at(&sheet, WIDTH + GAP + 10, 5)[c], 1.0, 0);
    image_finish(&picture);
    image_finish(&truth);
    image_finish(&sheet);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(map_tells_too_bright_from_too_dark, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(what_is_no_number_is_white, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
