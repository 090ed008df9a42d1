// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/preview.h"

#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/sheet/exposure.h"
#include "worker/sheet/pixel_font.h"

#include <ctype.h>
#include <fcntl.h>
#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { FILE_LIMIT = 6 };

struct folder {
    char path[64];
    char files[FILE_LIMIT][96];
    const char *names[FILE_LIMIT];
    size_t count;
    char sheet[96];
};

static void set_up(struct folder *folder)
{
    char sheet[sizeof folder->sheet];

    *folder = (struct folder){.path = "/tmp/preview_test_XXXXXX"};
    assert_non_null(mkdtemp(folder->path));
    snprintf(sheet, sizeof sheet, "%s/sheet.png", folder->path);
    memcpy(folder->sheet, sheet, sizeof sheet);
}

static void tear_down(struct folder *folder)
{
    for (size_t i = 0; i < folder->count; i++)
        unlink(folder->files[i]);
    unlink(folder->sheet);
    assert_int_equal(rmdir(folder->path), 0);
}

// Writes grey pixels with the value `even` or `odd` by the parity of the column.
static void add_file(struct folder *folder, int width, int height, float even, float odd)
{
    struct image_exr_header header = {.pixel = JOB_PIXEL_FLOAT, .fps_numerator = 24, .fps_denominator = 1};
    char path[sizeof folder->files[0]];
    struct image image;
    int fd;

    assert_true(image_init(&image, width, height, false, false, NULL));
    for (int i = 0; i < width * height; i++)
        for (int c = 0; c < 4; c++)
            image.rgba[i * 4 + c] = c == 3 ? 1.0f : i % width % 2 ? odd : even;
    snprintf(path, sizeof path, "%s/%zu.exr", folder->path, folder->count);
    memcpy(folder->files[folder->count], path, sizeof path);
    folder->names[folder->count] = folder->files[folder->count];
    fd = open(folder->files[folder->count++], O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    assert_true(image_exr_write(fd, &image, &header, 1, NULL));
    image_finish(&image);
    close(fd);
}

static struct preview_params make_params(const struct folder *folder)
{
    return (struct preview_params){.files = folder->names, .file_count = folder->count, .out = folder->sheet};
}

// Reads the sheet's bytes, 3 a pixel. The caller owns them.
static unsigned char *read_png(const char *path, int *width, int *height)
{
    png_image png = {.version = PNG_IMAGE_VERSION};
    unsigned char *rgb;

    assert_true(png_image_begin_read_from_file(&png, path));
    png.format = PNG_FORMAT_RGB;
    rgb = malloc(PNG_IMAGE_SIZE(png));
    assert_true(png_image_finish_read(&png, NULL, rgb, 0, NULL));
    *width = (int)png.width;
    *height = (int)png.height;
    return rgb;
}

static struct preview_result write_sheet(const struct preview_params *params)
{
    struct preview_result result;
    struct error error = {0};

    if (!preview_write_sheet(params, &result, &error)) fail_msg("%s", error.message);
    return result;
}

// Luminance is known to 1/128, which is 0.0113 stops and at most one or two steps of an 8-bit value.
static const double STOPS_TOLERANCE = 0.012;
static const int BYTE_TOLERANCE = 2;

static void one_exposure_takes_the_brightest_of_the_sequence_to_its_target(void **state)
{
    struct folder folder;
    struct preview_params params;
    struct preview_result result;
    unsigned char *rgb;
    int width, height;

    set_up(&folder);
    add_file(&folder, 16, 16, 0.1f, 0.1f);
    add_file(&folder, 16, 16, 0.4f, 0.4f);
    params = make_params(&folder);
    params.columns = 2;
    params.tile_width_px = 16;
    result = write_sheet(&params);
    assert_true(fabs(result.exposure - 1.0) < STOPS_TOLERANCE);
    rgb = read_png(folder.sheet, &width, &height);
    assert_int_equal(width, result.width_px);
    assert_int_equal(height, 16);
    // sRGB of 0.2 and of 0.8.
    assert_true(abs(rgb[0] - 124) <= BYTE_TOLERANCE);
    assert_true(abs(rgb[(width - 1) * 3] - 231) <= BYTE_TOLERANCE);
    free(rgb);
    tear_down(&folder);
}

static void given_exposure_is_obeyed_and_clips(void **state)
{
    struct folder folder;
    struct preview_params params;
    unsigned char *rgb;
    int width, height;

    set_up(&folder);
    add_file(&folder, 8, 8, 0.25f, 0.25f);
    params = make_params(&folder);
    params.has_exposure = true;
    params.exposure = 3;
    params.tile_width_px = 8;
    assert_true(write_sheet(&params).exposure == 3);
    rgb = read_png(folder.sheet, &width, &height);
    assert_int_equal(rgb[0], 255);
    free(rgb);
    tear_down(&folder);
}

static void black_sequence_is_exposed_by_nothing(void **state)
{
    struct folder folder;
    struct preview_params params;

    set_up(&folder);
    add_file(&folder, 8, 8, 0, 0);
    params = make_params(&folder);
    assert_true(write_sheet(&params).exposure == 0);
    tear_down(&folder);
}

static void small_light_in_the_dark_is_exposed_for(void **state)
{
    struct exposure *exposure = calloc(1, sizeof *exposure);
    struct image image;

    assert_true(image_init(&image, 100, 100, false, false, NULL));
    memset(image.rgba, 0, 100 * 100 * 4 * sizeof *image.rgba);
    for (int c = 0; c < 3; c++)
        image.rgba[5000 + c] = 0.2f;
    exposure_add_image(exposure, &image);
    assert_true(fabs(exposure_choose(exposure) - 2.0) < STOPS_TOLERANCE);
    image_finish(&image);
    free(exposure);
}

static void one_hot_pixel_in_a_thousand_does_not_darken_the_rest(void **state)
{
    struct exposure *exposure = calloc(1, sizeof *exposure);
    struct image image;

    assert_true(image_init(&image, 100, 10, false, false, NULL));
    for (int i = 0; i < 4000; i++)
        image.rgba[i] = i < 4 ? 1e6f : 0.4f;
    exposure_add_image(exposure, &image);
    assert_true(fabs(exposure_choose(exposure) - 1.0) < STOPS_TOLERANCE);
    image_finish(&image);
    free(exposure);
}

static void smaller_tile_holds_the_mean_of_linear_light(void **state)
{
    struct folder folder;
    struct preview_params params;
    unsigned char *rgb;
    int width, height;

    set_up(&folder);
    add_file(&folder, 12, 6, 0, 1);
    params = make_params(&folder);
    params.has_exposure = true;
    params.tile_width_px = 4; // three columns each, so some have two dark ones and some two bright ones
    write_sheet(&params);
    rgb = read_png(folder.sheet, &width, &height);
    assert_int_equal(width, 4);
    assert_int_equal(height, 2);
    // sRGB of 1/3 and of 2/3.
    assert_true(abs(rgb[0] - 156) <= 1);
    assert_true(abs(rgb[3] - 213) <= 1);
    free(rgb);
    tear_down(&folder);
}

static void label_stands_in_the_lower_left_corner(void **state)
{
    static const char *const labels[] = {"1"};
    struct folder folder;
    struct preview_params params;
    unsigned char *rgb;
    int width, height;

    set_up(&folder);
    add_file(&folder, 64, 64, 0.5f, 0.5f);
    params = make_params(&folder);
    params.labels = labels;
    params.tile_width_px = 64;
    write_sheet(&params);
    rgb = read_png(folder.sheet, &width, &height);
    // The foot of the 1 is above the box's black margin.
    assert_int_equal(rgb[(62 * 64 + 3) * 3], 255);
    assert_int_equal(rgb[(63 * 64 + 3) * 3], 0);
    assert_true(rgb[(30 * 64 + 30) * 3] > 200);
    free(rgb);
    tear_down(&folder);
}

static void label_is_cut_at_the_edge(void **state)
{
    unsigned char rgb[4 * 4 * 3] = {0};

    pixel_font_draw(rgb, 4, 4, -3, -2, 3, "8.8-8s");
    pixel_font_draw(rgb, 4, 4, 3, 3, 1, "\xff?");
    assert_int_equal(rgb[(3 * 4 + 3) * 3], 0);
}

static void names_of_files_can_be_told_apart(void **state)
{
    static const char characters[] = "0123456789.-_abcdefghijklmnopqrstuvwxyz";
    enum { WIDTH = PIXEL_FONT_WIDTH + 2, HEIGHT = PIXEL_FONT_HEIGHT + 2, COUNT = sizeof characters - 1 };
    unsigned char rgb[COUNT][WIDTH * HEIGHT * 3] = {0}, capital[WIDTH * HEIGHT * 3];

    for (int i = 0; i < COUNT; i++) {
        const char lower[] = {characters[i], 0}, upper[] = {(char)toupper(characters[i]), 0};

        pixel_font_draw(rgb[i], WIDTH, HEIGHT, 0, 0, 1, lower);
        assert_non_null(memchr(rgb[i], 255, sizeof rgb[i]));
        for (int j = 0; j < i; j++)
            assert_memory_not_equal(rgb[i], rgb[j], sizeof rgb[i]);
        pixel_font_draw(capital, WIDTH, HEIGHT, 0, 0, 1, upper);
        assert_memory_equal(capital, rgb[i], sizeof capital);
    }
}

static void box_of_a_label_fits_its_tile(void **state)
{
    assert_int_equal(pixel_font_count(2 * (3 * (PIXEL_FONT_WIDTH + 1) + 1), 2), 3);
    assert_int_equal(pixel_font_count(2 * (3 * (PIXEL_FONT_WIDTH + 1) + 1) - 1, 2), 2);
    assert_int_equal(pixel_font_count(0, 2), 0);
}

static void sheet_is_laid_out_near_three_to_two(void **state)
{
    struct folder folder;
    struct preview_params params;
    struct preview_result result;

    set_up(&folder);
    for (int i = 0; i < 6; i++)
        add_file(&folder, 4, 4, 0, 0);
    params = make_params(&folder);
    params.tile_width_px = 100;
    result = write_sheet(&params);
    assert_int_equal(result.width_px, 304);
    assert_int_equal(result.height_px, 202);
    tear_down(&folder);
}

static void assert_refused(const struct preview_params *params, const char *reason)
{
    struct preview_result result;
    struct error error = {0};

    assert_false(preview_write_sheet(params, &result, &error));
    if (!strstr(error.message, reason)) fail_msg("expected \"%s\" in \"%s\"", reason, error.message);
}

static void file_that_does_not_fit_or_cannot_be_read_is_named(void **state)
{
    struct folder folder;
    struct preview_params params;

    set_up(&folder);
    add_file(&folder, 8, 8, 0, 0);
    add_file(&folder, 8, 9, 0, 0);
    params = make_params(&folder);
    assert_refused(&params, "1.exr: expected 8 x 8 pixels as in the first file, got 8 x 9");
    assert_int_equal(truncate(folder.files[1], 300), 0);
    assert_refused(&params, "1.exr: ");
    unlink(folder.files[1]);
    assert_refused(&params, "1.exr: No such file");
    folder.count = 1;
    tear_down(&folder);
}

static void film_has_a_whole_picture_for_each_file(void **state)
{
    struct folder folder;
    struct preview_params params;
    struct preview_result result;
    char name[PREVIEW_NAME_SIZE], path[128];
    int width, height;

    set_up(&folder);
    add_file(&folder, 20, 10, 0.1f, 0.1f);
    add_file(&folder, 20, 10, 0.2f, 0.2f);
    params = make_params(&folder);
    params.out = folder.path;
    assert_true(preview_write_frames(&params, &result, NULL));
    assert_true(fabs(result.exposure - 2.0) < STOPS_TOLERANCE);
    for (size_t i = 0; i < 2; i++) {
        unsigned char *rgb;

        preview_format_name(i, name);
        snprintf(path, sizeof path, "%s/%s", folder.path, name);
        rgb = read_png(path, &width, &height);
        assert_int_equal(width, 20);
        assert_int_equal(height, 10);
        // sRGB of 0.4 and of 0.8.
        assert_true(abs(rgb[0] - (i == 0 ? 170 : 231)) <= BYTE_TOLERANCE);
        free(rgb);
        unlink(path);
    }
    tear_down(&folder);
}

static void film_of_pictures_that_differ_in_size_is_refused(void **state)
{
    struct folder folder;
    struct preview_params params;
    struct preview_result result;
    struct error error = {0};
    char name[PREVIEW_NAME_SIZE], path[128];

    set_up(&folder);
    add_file(&folder, 20, 10, 0.1f, 0.1f);
    add_file(&folder, 20, 12, 0.1f, 0.1f);
    params = make_params(&folder);
    params.out = folder.path;
    assert_false(preview_write_frames(&params, &result, &error));
    assert_non_null(strstr(error.message, "1.exr: expected 20 x 10 pixels as in the first file, got 20 x 12"));
    preview_format_name(0, name);
    snprintf(path, sizeof path, "%s/%s", folder.path, name);
    unlink(path);
    tear_down(&folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_exposure_takes_the_brightest_of_the_sequence_to_its_target),
        cmocka_unit_test(given_exposure_is_obeyed_and_clips),
        cmocka_unit_test(black_sequence_is_exposed_by_nothing),
        cmocka_unit_test(small_light_in_the_dark_is_exposed_for),
        cmocka_unit_test(one_hot_pixel_in_a_thousand_does_not_darken_the_rest),
        cmocka_unit_test(smaller_tile_holds_the_mean_of_linear_light),
        cmocka_unit_test(label_stands_in_the_lower_left_corner),
        cmocka_unit_test(label_is_cut_at_the_edge),
        cmocka_unit_test(names_of_files_can_be_told_apart),
        cmocka_unit_test(box_of_a_label_fits_its_tile),
        cmocka_unit_test(sheet_is_laid_out_near_three_to_two),
        cmocka_unit_test(file_that_does_not_fit_or_cannot_be_read_is_named),
        cmocka_unit_test(film_has_a_whole_picture_for_each_file),
        cmocka_unit_test(film_of_pictures_that_differ_in_size_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
