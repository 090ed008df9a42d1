// SPDX-License-Identifier: Apache-2.0
#include "worker/sheet/view.h"

#include "core/base/error.h"
#include "tests/support/temp_folder.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"
#include "worker/picture/srgb.h"

#include <fcntl.h>
#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { WIDTH = 40, HEIGHT = 24, WHITE = 255, FAR_GREY = 64 };

// Luminance is known to 1/128, which is 0.0113 stops.
static const double STOPS_TOLERANCE = 0.012;
// Values are floats: a byte is another only where it changes.
static const int BYTE_TOLERANCE = 1;

// All is dim but the upper right quarter, which is four times as bright; alpha is 0.5, blue does not pass, and the
// depth grows from 2 m to 10 m from left to right but in the last column, where there is none.
static int write_file(void **state, enum job_compression compression)
{
    struct image_exr_header header = {
        .pixel = JOB_PIXEL_FLOAT, .compression = compression, .fps_numerator = 24, .fps_denominator = 1, .frame = 7};
    struct image image;
    struct error error = {0};
    int fd = open(temp_folder_path(state, "a.exr"), O_CREAT | O_TRUNC | O_RDWR | O_CLOEXEC, 0600);

    header.job_name = "ash";
    assert_true(image_init(&image, WIDTH, HEIGHT, true, true, NULL));
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int x = i % WIDTH;

        for (int c = 0; c < 4; c++) {
            image.rgba[i * 4 + c] = c == 3 ? 0.5f : x < WIDTH / 2 || i / WIDTH >= HEIGHT / 2 ? 0.05f : 0.2f;
            image.transmittance[i * 4 + c] = c == 2 ? 0.0f : 1.0f;
        }
        image.depth[i] = x == WIDTH - 1 ? 0.0f : 2.0f + 8.0f * (float)x / (WIDTH - 2);
    }
    if (!image_exr_write(fd, &image, &header, 1, &error)) fail_msg("%s", error.message);
    image_finish(&image);
    return fd;
}

struct shown {
    struct view_result result;
    unsigned char *rgb; // owned
};

static struct shown show(void **state, struct view_params params)
{
    png_image png = {.version = PNG_IMAGE_VERSION};
    struct error error = {0};
    enum view_fault fault;
    struct shown shown;

    params.out = temp_folder_path(state, "a.png");
    if (!view_write(&params, &shown.result, &fault, &error)) fail_msg("%s", error.message);
    assert_true(png_image_begin_read_from_file(&png, params.out));
    png.format = PNG_FORMAT_RGB;
    shown.rgb = malloc(PNG_IMAGE_SIZE(png));
    assert_true(png_image_finish_read(&png, NULL, shown.rgb, 0, NULL));
    assert_int_equal(png.width, shown.result.width_px);
    assert_int_equal(png.height, shown.result.height_px);
    return shown;
}

static void assert_byte(int byte, int expected)
{
    if (abs(byte - expected) > BYTE_TOLERANCE) fail_msg("expected %d, got %d", expected, byte);
}

static void colour_has_the_exposure_that_its_brightest_pixels_need(void **state)
{
    static const enum job_compression compressions[] = {JOB_COMPRESSION_NONE, JOB_COMPRESSION_ZIP, JOB_COMPRESSION_PIZ};

    for (size_t i = 0; i < sizeof compressions / sizeof compressions[0]; i++) {
        int fd = write_file(state, compressions[i]);
        struct shown shown = show(state, (struct view_params){.fd = fd});

        assert_int_equal(shown.result.width_px, WIDTH);
        assert_int_equal(shown.result.file_height_px, HEIGHT);
        assert_true(fabs(shown.result.exposure - 2.0) < STOPS_TOLERANCE); // 0.2 becomes 0.8
        assert_true(isnan(shown.result.near));
        assert_byte(shown.rgb[0], srgb_encode_byte(0.2f));
        assert_byte(shown.rgb[3 * (WIDTH - 1) + 2], srgb_encode_byte(0.8f));
        free(shown.rgb);
        close(fd);
    }
}

static void exposure_of_a_part_is_that_of_the_whole(void **state)
{
    int fd = write_file(state, JOB_COMPRESSION_ZIP);
    struct shown shown = show(state, (struct view_params){.fd = fd, .x = 3, .y = 15, .width_px = 7, .height_px = 4});

    assert_int_equal(shown.result.width_px, 7);
    assert_int_equal(shown.result.height_px, 4);
    assert_true(fabs(shown.result.exposure - 2.0) < STOPS_TOLERANCE);
    assert_byte(shown.rgb[0], srgb_encode_byte(0.2f));
    free(shown.rgb);
    close(fd);
}

static void given_exposure_is_taken(void **state)
{
    int fd = write_file(state, JOB_COMPRESSION_ZIP);
    struct shown shown = show(state, (struct view_params){.fd = fd,
                                                          .has_exposure = true,
                                                          .exposure = 1,
                                                          .x = 18,
                                                          .y = 2,
                                                          .width_px = 4,
                                                          .height_px = 1,
                                                          .size_px = 2});

    assert_int_equal(shown.result.width_px, 2);
    assert_int_equal(shown.result.height_px, 1);
    assert_true(shown.result.exposure == 1.0);
    assert_byte(shown.rgb[0], srgb_encode_byte(0.1f));
    assert_byte(shown.rgb[3], srgb_encode_byte(0.4f));
    free(shown.rgb);
    close(fd);
}

static void alpha_and_transmittance_are_shown_as_they_are(void **state)
{
    int fd = write_file(state, JOB_COMPRESSION_ZIP);
    struct shown alpha = show(state, (struct view_params){.fd = fd, .channel = "A"});
    struct shown passed = show(state, (struct view_params){.fd = fd, .channel = "transmittance"});
    struct shown single = show(state, (struct view_params){.fd = fd, .channel = "transmittance.B"});

    assert_true(alpha.result.exposure == 0.0 && passed.result.exposure == 0.0);
    for (int c = 0; c < 3; c++) {
        assert_byte(alpha.rgb[c], srgb_encode_byte(0.5f));
        assert_int_equal(passed.rgb[c], c == 2 ? 0 : WHITE);
        assert_int_equal(single.rgb[c], 0);
    }
    free(alpha.rgb);
    free(passed.rgb);
    free(single.rgb);
    close(fd);
}

static void depth_is_white_near_and_grey_far_and_black_where_there_is_none(void **state)
{
    int fd = write_file(state, JOB_COMPRESSION_ZIP);
    struct shown shown = show(state, (struct view_params){.fd = fd, .channel = "Z"});
    struct shown part = show(state, (struct view_params){.fd = fd, .channel = "Z", .x = WIDTH - 2, .y = 3});

    assert_true(isnan(shown.result.exposure));
    assert_true(shown.result.near == 2.0 && shown.result.far == 10.0);
    assert_int_equal(shown.rgb[0], WHITE);
    assert_int_equal(shown.rgb[3 * (WIDTH - 2)], FAR_GREY);
    assert_int_equal(shown.rgb[3 * (WIDTH - 1)], 0);
    for (int x = 1; x < WIDTH - 1; x++)
        assert_true(shown.rgb[3 * x] <= shown.rgb[3 * (x - 1)]);
    assert_int_equal(part.rgb[0], FAR_GREY); // in a part, too
    free(shown.rgb);
    free(part.rgb);
    close(fd);
}

static void what_the_picture_lacks_is_refused_with_what_it_has(void **state)
{
    static const struct view_params wrong[] = {
        {.channel = "albedo"}, {.x = WIDTH}, {.y = 2, .height_px = HEIGHT - 1}, {.width_px = WIDTH + 1}};
    int fd = write_file(state, JOB_COMPRESSION_ZIP);

    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct view_params params = wrong[i];
        struct view_result result;
        struct error error = {0};
        enum view_fault fault;

        params.fd = fd;
        params.out = temp_folder_path(state, "none.png");
        assert_false(view_write(&params, &result, &fault, &error));
        assert_int_equal(fault, VIEW_FAULT_PARAMS);
        assert_non_null(
            strstr(error.message, i == 0 ? "color, A, B, G, R, Z, transmittance.B" : "inside the picture of 40 x 24"));
        assert_int_equal(access(params.out, F_OK), -1);
    }
    close(fd);
}

int main(int argc, char *argv[])
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        TEST(colour_has_the_exposure_that_its_brightest_pixels_need),
        TEST(exposure_of_a_part_is_that_of_the_whole),
        TEST(given_exposure_is_taken),
        TEST(alpha_and_transmittance_are_shown_as_they_are),
        TEST(depth_is_white_near_and_grey_far_and_black_where_there_is_none),
        TEST(what_the_picture_lacks_is_refused_with_what_it_has),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
