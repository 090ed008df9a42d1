// SPDX-License-Identifier: Apache-2.0
#include "worker/scene/texture_image.h"

#include "core/base/error.h"
#include "core/scene/scene.h"
#include "tests/support/exr_maker.h"
#include "tests/support/png_maker.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"
#include "worker/picture/image.h"

#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

enum { WIDTH = 7, HEIGHT = 5 };

static float value_at(size_t i)
{
    return (float)(i % 32) / 32.0f; // which half holds too
}

// One of its values, at pixel (3, 2), is `special`.
static char *write_exr(void **state, enum job_pixel pixel, float special)
{
    char *path = strdup(temp_folder_path(state, "texture.exr"));
    float rgb[WIDTH * HEIGHT * 3];

    for (size_t i = 0; i < sizeof rgb / sizeof rgb[0]; i++)
        rgb[i] = value_at(i / 3 * 4 + i % 3);
    rgb[3 * (2 * WIDTH + 3) + 1] = special;
    exr_maker_write(path, WIDTH, HEIGHT, pixel, rgb);
    return path;
}

static void load(struct image *image, const char *path, bool is_linear)
{
    const struct scene_texture texture = {.file = (char *)path, .is_linear = is_linear};
    struct error error = {{0}};
    int width, height;

    if (!texture_image_load(image, &texture, &error)) fail_msg("%s", error.message);
    assert_true(texture_image_find_size(path, &width, &height, NULL));
    assert_true(width == image->width_px && height == image->height_px);
}

static void expect_texture_error(const struct scene_texture *texture, const char *wanted)
{
    const char *path = texture->file;
    struct error error = {{0}};
    struct image image;

    assert_false(texture_image_load(&image, texture, &error));
    assert_null(image.rgba);
    assert_true(strncmp(error.message, path, strlen(path)) == 0);
    if (!strstr(error.message, wanted)) fail_msg("expected \"%s\", got \"%s\"", wanted, error.message);
}

static void expect_error(const char *path, const char *wanted)
{
    expect_texture_error(&(struct scene_texture){.file = (char *)path, .is_linear = true}, wanted);
}

static double light_of(double value)
{
    return value <= 0.04045 ? value / 12.92 : exp(2.4 * log((value + 0.055) / 1.055));
}

static void exr_gives_its_values(void **state)
{
    for (int i = 0; i < 4; i++) {
        char *path = write_exr(state, i & 1 ? JOB_PIXEL_HALF : JOB_PIXEL_FLOAT, 1);
        bool is_linear = i & 2;
        struct image image;

        load(&image, path, is_linear);
        assert_true(image.width_px == WIDTH && image.height_px == HEIGHT);
        for (size_t k = 0; k < (size_t)WIDTH * HEIGHT * 4; k++) {
            double stored = k == 4 * (2 * WIDTH + 3) + 1 ? 1 : (double)value_at(k);
            double wanted = is_linear ? stored : light_of(stored);

            if (k % 4 == 3) continue;
            assert_true(fabs((double)image.rgba[k] - wanted) <= wanted * 0.5000001 * 0x1p-23);
        }
        image_finish(&image);
        free(path);
    }
}

static void png_gives_its_values(void **state)
{
    static const unsigned char rgb[] = {255, 0, 51, 10, 128, 11};
    const char *path = temp_folder_path(state, "texture.png");
    struct image image;

    png_maker_write_rgb(path, 2, 1, rgb);
    for (int is_linear = 0; is_linear < 2; is_linear++) {
        load(&image, path, is_linear);
        for (size_t i = 0; i < 6; i++) {
            double wanted = is_linear ? rgb[i] / 255.0 : light_of(rgb[i] / 255.0);

            assert_true(fabs((double)image.rgba[i / 3 * 4 + i % 3] - wanted) <= wanted * 0.5000001 * 0x1p-23);
        }
        image_finish(&image);
    }
}

// No albedo: it would reflect more than it meets, less than nothing, or nobody knows what.
static void values_that_are_no_albedo_are_named(void **state)
{
    static const struct {
        float value;
        const char *message;
    } cases[] = {{1.5f, "channel G at pixel (3, 2) is 1.5: expected a value in [0, 1]"},
                 {-0.25f, "channel G at pixel (3, 2) is -0.25: "},
                 {NAN, "channel G at pixel (3, 2) is nan: "},
                 {-NAN, "channel G at pixel (3, 2) is -nan: "},
                 {INFINITY, "channel G at pixel (3, 2) is inf: "}};

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *path = write_exr(state, JOB_PIXEL_FLOAT, cases[i].value);

        expect_error(path, cases[i].message);
        free(path);
    }
}

static void radiance_is_not_limited_by_albedo(void **state)
{
    static const struct {
        float value;
        const char *message;
    } wrong[] = {{2e9f, "channel G at pixel (3, 2) is 2e+09: expected a value in [0, 1000000000]"},
                 {-0.25f, "channel G at pixel (3, 2) is -0.25: "},
                 {NAN, "channel G at pixel (3, 2) is nan: "},
                 {INFINITY, "channel G at pixel (3, 2) is inf: "}};
    struct scene_texture texture = {.is_linear = true, .is_radiance = true};
    struct error error = {{0}};
    struct image image;

    texture.file = write_exr(state, JOB_PIXEL_FLOAT, 1e5f);
    if (!texture_image_load(&image, &texture, &error)) fail_msg("%s", error.message);
    assert_true(image.rgba[4 * (2 * WIDTH + 3) + 1] == 1e5f);
    image_finish(&image);
    free(texture.file);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        texture.file = write_exr(state, JOB_PIXEL_FLOAT, wrong[i].value);
        expect_texture_error(&texture, wrong[i].message);
        free(texture.file);
    }
}

static void damaged_files_are_refused(void **state)
{
    char *path = write_exr(state, JOB_PIXEL_HALF, 1);
    struct stat status;

    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(truncate(path, status.st_size - 20), 0);
    expect_error(path, "line");
    assert_int_equal(truncate(path, 3), 0);
    expect_error(path, "expected the contents of a");
    assert_int_equal(truncate(path, 0), 0);
    expect_error(path, "expected the contents of a");
    free(path);
}

static void what_is_no_file_is_refused(void **state)
{
    const char *path = temp_folder_path(state, "missing.png");
    int width, height;

    expect_error(path, "No such file");
    assert_false(texture_image_find_size(path, &width, &height, NULL));
    assert_int_equal(mkdir(path, 0700), 0);
    expect_error(path, "expected a regular file");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(exr_gives_its_values, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(png_gives_its_values, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(values_that_are_no_albedo_are_named, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(radiance_is_not_limited_by_albedo, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(damaged_files_are_refused, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(what_is_no_file_is_refused, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
