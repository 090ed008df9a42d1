// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "tests/support/random.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

enum { ROWS = 16 }; // of a chunk, with zip

static int write_image(const struct image *image, const struct image_exr_header *header, int thread_count)
{
    struct error error = {0};
    int fd = memfd_create("frame", MFD_CLOEXEC);

    assert_true(fd >= 0);
    if (!image_exr_write(fd, image, header, thread_count, &error)) fail_msg("%s", error.message);
    return fd;
}

static void assert_same_values(const float *found, const float *image, size_t count, size_t components, size_t used,
                               enum job_pixel pixel)
{
    for (size_t i = 0; i < count * components; i++) {
        float expected = image_exr_stored(image[i], pixel);

        if (i % components < used) assert_memory_equal(&found[i], &expected, sizeof expected);
    }
}

static void assert_comes_back(const struct image *image, const struct image_exr_header *header, int thread_count)
{
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    struct error error = {0};
    struct image found;
    int fd = write_image(image, header, thread_count);

    if (!image_exr_read(fd, &found, NULL, thread_count, &error)) fail_msg("%s", error.message);
    assert_true(image_fits(&found, image->width_px, image->height_px, image->depth, image->transmittance));
    assert_same_values(found.rgba, image->rgba, count, 4, 4, header->pixel);
    if (image->transmittance) assert_same_values(found.transmittance, image->transmittance, count, 4, 3, header->pixel);
    if (image->depth) assert_same_values(found.depth, image->depth, count, 1, 1, JOB_PIXEL_FLOAT);
    image_finish(&found);
    close(fd);
}

static void fill_rows(struct image *image, int first_row, int row_count, float colour, float light, float depth)
{
    for (int i = first_row * image->width_px; i < (first_row + row_count) * image->width_px; i++) {
        for (int c = 0; c < 4; c++)
            image->rgba[i * 4 + c] = colour;
        for (int c = 0; c < 4 && image->transmittance; c++)
            image->transmittance[i * 4 + c] = light;
        if (image->depth) image->depth[i] = depth;
    }
}

// Chunks that each are the same in all their pixels: neighbours are equal, or differ in the bits of one channel, which
// may be the sign of zero or a value below the least normal one. A few have one pixel of another value, at an end.
static void paint_chunks(struct image *image, struct random *random)
{
    static const float values[] = {0.0f, -0.0f, 1.0f, 5.9604645e-8f, 1e-41f, -1e-41f};
    enum { VALUE_COUNT = sizeof values / sizeof values[0] };
    int kept[3] = {0};

    for (int y = 0; y < image->height_px; y += ROWS) {
        int row_count = image->height_px - y < ROWS ? image->height_px - y : ROWS;
        size_t first = (size_t)y * (size_t)image->width_px, end = first + (size_t)row_count * (size_t)image->width_px;

        if (random_between(random, 0, 1) < 0.5)
            kept[(int)random_between(random, 0, 3)] = (int)random_between(random, 0, VALUE_COUNT);
        fill_rows(image, y, row_count, values[kept[0]], values[kept[1]], values[kept[2]]);
        if (random_between(random, 0, 1) < 0.2) image->rgba[4 * first] = 0.5f;
        if (random_between(random, 0, 1) < 0.2) image->rgba[4 * end - 1] = 0.5f;
        if (image->depth && random_between(random, 0, 1) < 0.2) image->depth[end - 1] = 0.5f;
        if (image->transmittance && random_between(random, 0, 1) < 0.2) image->transmittance[4 * end - 2] = 0.5f;
    }
}

static void chunks_of_one_value_come_back_to_the_bit(void **state)
{
    static const int widths[] = {1, 2, 3, 16, 67};
    struct random random = {9};

    for (int trial = 0; trial < 200; trial++) {
        struct image_exr_header header = {.pixel = trial & 1 ? JOB_PIXEL_HALF : JOB_PIXEL_FLOAT,
                                          .compression = trial & 2 ? JOB_COMPRESSION_ZIPS : JOB_COMPRESSION_ZIP,
                                          .fps_denominator = 1};
        int height = 1 + (int)random_between(&random, 0, 150);
        struct image image;

        assert_true(image_init(&image, widths[trial % 5], height, trial & 4, trial & 8, NULL));
        paint_chunks(&image, &random);
        assert_comes_back(&image, &header, 1);
        assert_comes_back(&image, &header, 2);
        image_finish(&image);
    }
}

static void assert_refused(const struct image *image, const struct image_exr_header *header)
{
    for (int threads = 1; threads <= 2; threads++) {
        struct error error = {0};
        int fd = memfd_create("frame", MFD_CLOEXEC);

        assert_false(image_exr_write(fd, image, header, threads, &error));
        assert_int_equal(errno, 0);
        assert_true(error.message[0]);
        close(fd);
    }
}

static void assert_checked(struct image *image, enum job_pixel pixel, enum job_compression compression)
{
    struct image_exr_header header = {
        .pixel = pixel, .compression = compression, .fps_denominator = 1, .is_checked = true};
    size_t count = (size_t)image->width_px * (size_t)image->height_px;
    float *const last[] = {&image->rgba[4 * count - 1], &image->transmittance[4 * count - 2], &image->depth[count - 1]};

    fill_rows(image, 0, image->height_px, 0.5f, 1.0f, 7e4f); // depth is never written as half
    image->transmittance[3] = NAN;                           // belongs to no channel
    close(write_image(image, &header, 2));
    for (size_t i = 0; i < sizeof last / sizeof last[0]; i++) {
        float before = *last[i];

        *last[i] = i == 1 ? -INFINITY : NAN;
        assert_refused(image, &header);
        *last[i] = before;
    }
    image->rgba[4 * (count / 2)] = 65505.0f;
    if (pixel == JOB_PIXEL_HALF) assert_refused(image, &header);
    if (pixel == JOB_PIXEL_FLOAT) close(write_image(image, &header, 2));
}

static void values_are_checked_while_they_are_packed(void **state)
{
    struct image image;

    assert_true(image_init(&image, 19, 37, true, true, NULL));
    for (int i = JOB_COMPRESSION_NONE; i <= JOB_COMPRESSION_PIZ; i++) {
        assert_checked(&image, JOB_PIXEL_HALF, (enum job_compression)i);
        assert_checked(&image, JOB_PIXEL_FLOAT, (enum job_compression)i);
    }
    image_finish(&image);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chunks_of_one_value_come_back_to_the_bit),
        cmocka_unit_test(values_are_checked_while_they_are_packed),
    };

    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
