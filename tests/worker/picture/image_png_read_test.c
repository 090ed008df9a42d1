// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_png_read.h"

#include "core/base/error.h"
#include "tests/support/png_maker.h"
#include "tests/support/random.h"
#include "worker/picture/image.h"
#include "worker/picture/srgb.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

enum { VALUE_LIMIT = 4 * 40 * 40 };

static const struct {
    enum png_color color;
    int bits;
} forms[] = {{PNG_GREY, 1},    {PNG_GREY, 2},       {PNG_GREY, 4},        {PNG_GREY, 8},      {PNG_GREY, 16},
             {PNG_RGB, 8},     {PNG_RGB, 16},       {PNG_PALETTE, 1},     {PNG_PALETTE, 2},   {PNG_PALETTE, 4},
             {PNG_PALETTE, 8}, {PNG_GREY_ALPHA, 8}, {PNG_GREY_ALPHA, 16}, {PNG_RGB_ALPHA, 8}, {PNG_RGB_ALPHA, 16}};

enum { FORM_COUNT = sizeof forms / sizeof forms[0] };

static unsigned char palette[256][3];
static uint16_t values[VALUE_LIMIT];

static struct png_params make_params(size_t form, int width, int height, bool is_interlaced)
{
    struct random random = {form + 1};
    int bits = forms[form].bits;

    for (int i = 0; i < 256; i++)
        for (int c = 0; c < 3; c++)
            palette[i][c] = (unsigned char)random_between(&random, 0, 256);
    for (int i = 0; i < VALUE_LIMIT; i++)
        values[i] = (uint16_t)random_between(&random, 0, 1 << bits);
    return (struct png_params){.width = width,
                               .height = height,
                               .color = forms[form].color,
                               .bits = bits,
                               .is_interlaced = is_interlaced,
                               .values = values,
                               .palette = (const unsigned char(*)[3])palette,
                               .palette_count = bits < 8 ? 1 << bits : 256};
}

static int put(const void *bytes, size_t size)
{
    int fd = memfd_create("png", MFD_CLOEXEC);

    assert_true(fd >= 0);
    assert_int_equal(write(fd, bytes, size), size);
    return fd;
}

// Returns the stored value of a channel in [0, 1] as the standard defines it.
static double value_of(const struct png_params *params, size_t pixel, size_t channel)
{
    size_t channels = (size_t)png_maker_channels(params->color);
    const uint16_t *stored = params->values + pixel * channels;

    if (params->color == PNG_PALETTE) return params->palette[*stored][channel] / 255.0;
    return stored[channels >= 3 ? channel : 0] / (double)((1 << params->bits) - 1);
}

// IEC 61966-2-1, 5.2.
static double light_of(double value)
{
    return value <= 0.04045 ? value / 12.92 : exp(2.4 * log((value + 0.055) / 1.055));
}

static void assert_read(const struct png_params *params, bool is_linear)
{
    size_t size;
    unsigned char *bytes = png_maker_make(params, &size);
    int fd = put(bytes, size);
    struct image_png_facts facts;
    struct error error = {{0}};
    struct image image;

    if (!image_png_read(fd, is_linear, &image, &facts, &error)) fail_msg("%s", error.message);
    assert_int_equal(facts.width_px, params->width);
    assert_int_equal(facts.height_px, params->height);
    assert_int_equal(facts.bits, params->bits);
    assert_int_equal(image.width_px, params->width);
    assert_int_equal(image.height_px, params->height);
    for (size_t i = 0; i < (size_t)params->width * (size_t)params->height; i++) {
        for (size_t c = 0; c < 3; c++) {
            double value = value_of(params, i, c), wanted = is_linear ? value : light_of(value);

            // The value is rounded once to a float; the formula in double precision rounds much less.
            assert_true(fabs((double)image.rgba[4 * i + c] - wanted) <= wanted * 0.5000001 * 0x1p-23);
        }
        assert_true(image.rgba[4 * i + 3] == 1.0f);
    }
    image_finish(&image);
    close(fd);
    free(bytes);
}

static void every_form_gives_its_values(void **state)
{
    static const int sizes[][2] = {{1, 1}, {3, 2}, {9, 17}, {40, 33}};

    for (size_t form = 0; form < FORM_COUNT; form++)
        for (size_t size = 0; size < sizeof sizes / sizeof sizes[0]; size++)
            for (int i = 0; i < 4; i++) {
                struct png_params params = make_params(form, sizes[size][0], sizes[size][1], i & 1);

                assert_read(&params, i & 2);
            }
}

static void curve_is_that_of_the_standard(void **state)
{
    assert_true(srgb_decode(0) == 0 && srgb_decode(1) == 1);
    // Half of the code values of 8 bits, by the standard's formula.
    assert_true(fabs(srgb_decode(128 / 255.0) - 0.2158605) < 1e-7);
    assert_true(fabs(srgb_decode(10 / 255.0) - 10 / 255.0 / 12.92) < 1e-16);
    assert_true(fabs(srgb_decode(11 / 255.0) - 0.0033465358) < 1e-10);
    for (int i = 0; i <= 65535; i++)
        assert_true(fabs(srgb_decode(i / 65535.0) - light_of(i / 65535.0)) < 1e-15);
}

static void header_is_read_alone(void **state)
{
    struct png_params params = make_params(6, 40, 33, true);
    struct image_png_facts facts;
    size_t size;
    unsigned char *bytes = png_maker_make(&params, &size);
    int fd = put(bytes, 8 + 25 + 16 + 12); // up to where the pixels begin

    assert_true(image_png_read(fd, false, NULL, &facts, NULL));
    assert_true(facts.width_px == 40 && facts.height_px == 33 && facts.bits == 16);
    close(fd);
    free(bytes);
}

static void expect_error(const void *bytes, size_t size, const char *wanted)
{
    struct error error = {{0}};
    struct image image;
    int fd = put(bytes, size);

    assert_false(image_png_read(fd, false, &image, NULL, &error));
    assert_null(image.rgba);
    if (!strstr(error.message, wanted)) fail_msg("expected \"%s\", got \"%s\"", wanted, error.message);
    close(fd);
}

static void file_cut_anywhere_is_refused(void **state)
{
    for (size_t form = 0; form < FORM_COUNT; form++) {
        struct png_params params = make_params(form, 7, 5, form & 1);
        size_t size;
        unsigned char *bytes = png_maker_make(&params, &size);

        for (size_t length = 0; length < size; length++)
            expect_error(bytes, length, "PNG: the file ends too soon");
        free(bytes);
    }
}

// Each chunk has a checksum, and so has the stream of pixels.
static void flipped_byte_is_refused(void **state)
{
    struct png_params params = make_params(5, 19, 11, false);
    struct error error = {{0}};
    struct image image;
    size_t size, refused = 0;
    unsigned char *bytes = png_maker_make(&params, &size);

    for (size_t at = 0; at < size; at++) {
        int fd;

        bytes[at] ^= 0x10;
        fd = put(bytes, size);
        if (image_png_read(fd, false, &image, NULL, &error))
            image_finish(&image);
        else
            refused++;
        close(fd);
        bytes[at] ^= 0x10;
    }
    // All but those of gamma, which is not read.
    assert_true(refused >= size - 16);
    free(bytes);
}

static void colour_beyond_the_palette_is_named(void **state)
{
    struct png_params params = make_params(10, 5, 4, false);
    unsigned char *bytes;
    size_t size;

    memset(values, 0, sizeof values);
    values[5 * 2 + 3] = 9;
    params.palette_count = 9;
    bytes = png_maker_make(&params, &size);
    expect_error(bytes, size, "PNG: pixel (3, 2) has colour 9 of a palette of 9");
    free(bytes);
}

static void large_sides_are_refused(void **state)
{
    uint16_t *zeros = calloc(16385 * 8, sizeof *zeros);
    size_t size;
    unsigned char *bytes = png_maker_make(
        &(struct png_params){.width = 16385, .height = 1, .color = PNG_GREY, .bits = 8, .values = zeros}, &size);

    expect_error(bytes, size, "PNG: expected sides of at most 16384 pixels, got 16385 x 1");
    free(bytes);
    free(zeros);
}

static void other_files_are_refused(void **state)
{
    expect_error("GIF89a and so on", 16, "PNG: Not a PNG file");
}

static long peak_kib(void)
{
    struct rusage usage;

    assert_int_equal(getrusage(RUSAGE_SELF, &usage), 0);
    return usage.ru_maxrss;
}

// 50 texts of 7 MB, in a file of half a megabyte.
static void compressed_texts_stay_packed(void **state)
{
    struct png_params params = make_params(5, 9, 17, false);
    long before;

    params.text_count = 50;
    params.text_size = 7000000;
    before = peak_kib();
    assert_read(&params, false);
    assert_true(peak_kib() - before < 100 * 1024);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_form_gives_its_values),  cmocka_unit_test(curve_is_that_of_the_standard),
        cmocka_unit_test(header_is_read_alone),         cmocka_unit_test(file_cut_anywhere_is_refused),
        cmocka_unit_test(flipped_byte_is_refused),      cmocka_unit_test(colour_beyond_the_palette_is_named),
        cmocka_unit_test(large_sides_are_refused),      cmocka_unit_test(other_files_are_refused),
        cmocka_unit_test(compressed_texts_stay_packed),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
