// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/level_png.h"

#include "core/base/error.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/picture/image_png_read.h"
#include "worker/picture/picture_level.h"
#include "worker/picture/srgb.h"
#include "worker/sheet/exposure.h"

#include <dirent.h>
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

enum { WIDTH = 22, HEIGHT = 11, STRIDE = 4, COLUMNS = 7, ROWS = 4, POINTS = COLUMNS * ROWS };

static void fill(float *rgba, int count)
{
    for (int i = 0; i < 4 * count; i++)
        rgba[i] = i % 4 == 3 ? 1.0f : 0.01f * (float)(1 + i % 89);
}

static struct picture_level level_of(float *rgba)
{
    return (struct picture_level){
        .rgba = rgba, .stride = STRIDE, .columns = COLUMNS, .rows = ROWS, .width_px = WIDTH, .height_px = HEIGHT};
}

static void read_back(const char *path, struct image *shown)
{
    int fd = open(path, O_RDONLY);

    assert_true(fd >= 0);
    assert_true(image_png_read(fd, true, shown, NULL, NULL));
    close(fd);
}

static double expect(const struct image *image, float value)
{
    static struct exposure exposure;

    exposure = (struct exposure){.lit = 0};
    exposure_add_image(&exposure, image);
    return srgb_encode_byte(value * (float)exp2(exposure_choose(&exposure)));
}

// The picture is no multiple of the stride, so the last points lie beyond it.
static void each_pixel_shows_the_point_next_to_it(void **state)
{
    const char *path = temp_folder_path(state, "level.png");
    float rgba[4 * POINTS];
    const struct image points = {.width_px = COLUMNS, .height_px = ROWS, .rgba = rgba};
    const struct picture_level level = level_of(rgba);
    struct image shown;

    fill(rgba, POINTS);
    assert_true(level_png_write(path, &level, NULL));
    read_back(path, &shown);
    assert_int_equal(shown.width_px, WIDTH);
    assert_int_equal(shown.height_px, HEIGHT);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++) {
                int column = (int)floor(x / 4.0 + 0.5), row = (int)floor(y / 4.0 + 0.5);
                double byte = 255.0 * (double)shown.rgba[4 * (y * WIDTH + x) + c];

                assert_float_equal(byte, expect(&points, rgba[4 * (row * COLUMNS + column) + c]), 1e-3);
            }
    image_finish(&shown);
}

static void whole_picture_is_shown_pixel_by_pixel(void **state)
{
    const char *path = temp_folder_path(state, "whole.png");
    struct picture_level level = {
        .stride = 1, .columns = WIDTH, .rows = HEIGHT, .width_px = WIDTH, .height_px = HEIGHT};
    struct image image, shown;

    assert_true(image_init(&image, WIDTH, HEIGHT, false, false, NULL));
    fill(image.rgba, WIDTH * HEIGHT);
    level.rgba = image.rgba;
    assert_true(level_png_write(path, &level, NULL));
    read_back(path, &shown);
    for (int i = 0; i < 4 * WIDTH * HEIGHT; i++)
        if (i % 4 < 3) assert_float_equal(255.0 * (double)shown.rgba[i], expect(&image, image.rgba[i]), 1e-3);
    image_finish(&image);
    image_finish(&shown);
}

static int count_files(const char *folder)
{
    DIR *open_folder = opendir(folder);
    int count = 0;

    assert_non_null(open_folder);
    while (readdir(open_folder))
        count++;
    closedir(open_folder);
    return count - 2;
}

// A reader who has opened the old file goes on to read it.
static void file_is_replaced_whole_or_not_at_all(void **state)
{
    const char *path = temp_folder_path(state, "level.png");
    float rgba[4 * POINTS];
    const struct picture_level level = level_of(rgba);
    struct stat before, after;
    struct error error = {0};
    int reader;

    fill(rgba, POINTS);
    assert_true(level_png_write(path, &level, NULL));
    reader = open(path, O_RDONLY);
    assert_int_equal(fstat(reader, &before), 0);
    assert_true(level_png_write(path, &level, NULL));
    assert_int_equal(stat(path, &after), 0);
    assert_true(before.st_ino != after.st_ino);
    assert_int_equal(before.st_size, after.st_size);
    close(reader);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(mkdir(path, 0777), 0);
    assert_false(level_png_write(path, &level, &error));
    assert_non_null(strstr(error.message, "cannot rename"));
    assert_int_equal(count_files(*state), 1);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(each_pixel_shows_the_point_next_to_it, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(whole_picture_is_shown_pixel_by_pixel, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(file_is_replaced_whole_or_not_at_all, temp_folder_create, temp_folder_destroy),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]); // for tests/mutations
    return cmocka_run_group_tests(tests, NULL, NULL);
}
