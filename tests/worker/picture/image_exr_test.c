// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr.h"

#include "core/base/error.h"
#include "tests/support/random.h"
#include "worker/picture/image.h"

#define IMATH_HALF_NO_LOOKUP_TABLE
#include <Imath/half.h>
#include <OpenEXR/openexr.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static const enum job_compression compressions[] = {JOB_COMPRESSION_NONE, JOB_COMPRESSION_RLE, JOB_COMPRESSION_ZIPS,
                                                    JOB_COMPRESSION_ZIP, JOB_COMPRESSION_PIZ};
enum { COMPRESSION_COUNT = sizeof compressions / sizeof compressions[0] };

// Half of the picture is smooth and half is noise, so that some chunks compress and some do not.
static struct image make_image(int width, int height, bool has_depth, bool has_transmittance, uint32_t seed)
{
    struct random random = {seed};
    struct image image;

    assert_true(image_init(&image, width, height, has_depth, has_transmittance, NULL));
    for (int i = 0; i < width * height; i++) {
        bool is_smooth = i % width < width / 2;

        for (int c = 0; c < 4; c++) {
            image.rgba[i * 4 + c] = is_smooth ? (float)(i / width) * 0.01f : (float)random_between(&random, -1, 7);
            if (has_transmittance) image.transmittance[i * 4 + c] = c == 3 ? NAN : (float)random_between(&random, 0, 1);
        }
        if (has_depth) image.depth[i] = (float)random_between(&random, 0, 1e6);
    }
    return image;
}

static struct image_exr_header make_header(enum job_pixel pixel, enum job_compression compression)
{
    struct image_exr_header header = {
        .pixel = pixel,
        .compression = compression,
        .fps_numerator = 24000,
        .fps_denominator = 1001,
        .owner = "ada",
        .job_id = 5000000007,
        .job_hash = "0123456789abcdef0123456789abcdef",
        .frame = 42,
        .attempt = 2,
        .method = "midpoint",
        .step = 0.01,
        .backend = "osmesa",
        .renderer = "llvmpipe",
        .shader_hash = "fedcba9876543210fedcba9876543210",
        .render_seconds = 1.25,
        .rays =
            {.is_known = true, .rays_per_pixel = 5.5, .cut_rays = 0.75, .cut_share = 1.0 / 3.0, .cut_tolerance = 0.01},
        .sequence_hash = "00000000000000000000000000000001",
        .audit = {.kind = AUDIT_STEP_HALVING,
                  .is_pooled = true,
                  .error = 0.0078125,
                  .error95 = 0.015625,
                  .ray_count = 64,
                  .tolerance = 0.01},
        .sampling_error = 0.125,
        .plan = "a grid of light pays",
        .captured = 1000000000,
    };

    for (int i = 0; i < 16; i++) {
        header.world_to_camera[i] = i * 0.5;
        header.world_to_ndc[i] = -i;
    }
    return header;
}

static int write_image(const struct image *image, const struct image_exr_header *header, int thread_count)
{
    struct error error = {0};
    int fd = memfd_create("frame", MFD_CLOEXEC);

    assert_true(fd >= 0);
    if (!image_exr_write(fd, image, header, thread_count, &error)) fail_msg("%s", error.message);
    return fd;
}

static float stored(float value, enum job_pixel pixel)
{
    return pixel == JOB_PIXEL_HALF ? imath_half_to_float(imath_float_to_half(value)) : value;
}

static void assert_same_bits(float found, float expected)
{
    assert_memory_equal(&found, &expected, sizeof found);
}

static void assert_round_trip(int width, int height, enum job_pixel pixel, enum job_compression compression, bool aovs)
{
    struct image image = make_image(width, height, aovs, aovs, 7);
    struct image_exr_header header = make_header(pixel, compression);
    struct image_exr_facts facts;
    struct image found;
    struct error error = {0};
    int fd = write_image(&image, &header, 2);

    if (!image_exr_read(fd, &found, &facts, 3, &error)) fail_msg("%s", error.message);
    assert_int_equal(found.width_px, width);
    assert_int_equal(found.height_px, height);
    assert_int_equal(facts.pixel, pixel);
    assert_int_equal(facts.compression, compression);
    assert_int_equal(facts.has_depth, aovs);
    assert_int_equal(facts.has_transmittance, aovs);
    for (int i = 0; i < width * height * 4; i++) {
        assert_same_bits(found.rgba[i], stored(image.rgba[i], pixel));
        if (aovs && i % 4 < 3) assert_same_bits(found.transmittance[i], stored(image.transmittance[i], pixel));
        if (aovs && i % 4 == 0) assert_same_bits(found.depth[i / 4], image.depth[i / 4]);
    }
    image_finish(&found);
    image_finish(&image);
    close(fd);
}

static void every_compression_and_pixel_type_comes_back_to_the_bit(void **state)
{
    static const int sizes[][2] = {{1, 1}, {2, 1}, {1, 37}, {17, 33}, {64, 70}};

    for (size_t size = 0; size < sizeof sizes / sizeof sizes[0]; size++)
        for (int i = 0; i < COMPRESSION_COUNT; i++)
            for (int pixel = 0; pixel < 2; pixel++)
                for (int aovs = 0; aovs < 2; aovs++)
                    assert_round_trip(sizes[size][0], sizes[size][1], (enum job_pixel)pixel, compressions[i], aovs);
}

// A chunk that compresses to exactly its own size must not be taken for a raw one. About one in a hundred of these
// does.
static void chunk_that_does_not_shrink_comes_back_to_the_bit(void **state)
{
    struct random random = {1};

    for (int width = 8; width < 200; width++)
        for (int calm = 0; calm < 24; calm++) {
            struct image_exr_header header = make_header(JOB_PIXEL_HALF, JOB_COMPRESSION_ZIPS);
            struct image image, found;
            struct error error = {0};
            int fd;

            assert_true(image_init(&image, width, 1, false, false, NULL));
            for (int i = 0; i < width * 4; i++)
                image.rgba[i] = i % 4 == 0 && i < calm * 2 ? 0.0f : (float)random_between(&random, 0, 1);
            fd = write_image(&image, &header, 1);
            if (!image_exr_read(fd, &found, NULL, 1, &error)) fail_msg("%s", error.message);
            for (int i = 0; i < width * 4; i++)
                assert_same_bits(found.rgba[i], stored(image.rgba[i], JOB_PIXEL_HALF));
            image_finish(&found);
            image_finish(&image);
            close(fd);
        }
}

static char *read_bytes(int fd, size_t *size)
{
    struct stat status;
    char *bytes;

    assert_int_equal(fstat(fd, &status), 0);
    *size = (size_t)status.st_size;
    bytes = malloc(*size);
    assert_int_equal(pread(fd, bytes, *size, 0), *size);
    return bytes;
}

static void thread_count_does_not_change_the_bytes(void **state)
{
    for (int i = 0; i < COMPRESSION_COUNT; i++) {
        struct image image = make_image(123, 217, true, true, 3);
        struct image_exr_header header = make_header(JOB_PIXEL_HALF, compressions[i]);
        int one = write_image(&image, &header, 1), four = write_image(&image, &header, 4);
        size_t one_size, four_size;
        char *one_bytes = read_bytes(one, &one_size), *four_bytes = read_bytes(four, &four_size);

        assert_int_equal(one_size, four_size);
        assert_memory_equal(one_bytes, four_bytes, one_size);
        free(one_bytes);
        free(four_bytes);
        image_finish(&image);
        close(one);
        close(four);
    }
}

static void facts_are_read_back_without_the_pixels(void **state)
{
    struct image image = make_image(5, 4, true, false, 1);
    struct image_exr_header header = make_header(JOB_PIXEL_FLOAT, JOB_COMPRESSION_PIZ);
    struct image_exr_facts facts;
    int fd = write_image(&image, &header, 1);

    assert_true(image_exr_read(fd, NULL, &facts, 1, NULL));
    assert_int_equal(facts.width_px, 5);
    assert_int_equal(facts.height_px, 4);
    assert_int_equal(facts.job_id, 5000000007);
    assert_string_equal(facts.job_hash, header.job_hash);
    assert_int_equal(facts.frame, 42);
    assert_true(facts.render_seconds == 1.25);
    assert_true(facts.has_alpha && facts.has_depth && !facts.has_transmittance);
    assert_true(facts.rays.is_known && facts.rays.rays_per_pixel == 5.5 && facts.rays.cut_rays == 0.75);
    assert_true(facts.rays.cut_share == 1.0 / 3.0 && facts.rays.cut_tolerance == 0.01);
    image_finish(&image);
    close(fd);
}

static void audit_and_plan_are_read_back(void **state)
{
    struct image image = make_image(5, 4, false, false, 1);
    struct image_exr_header header = make_header(JOB_PIXEL_HALF, JOB_COMPRESSION_ZIP);
    struct image_exr_facts facts;
    int fd = write_image(&image, &header, 1);

    assert_true(image_exr_read(fd, NULL, &facts, 1, NULL));
    assert_int_equal(facts.audit.kind, AUDIT_STEP_HALVING);
    assert_true(facts.audit.is_pooled && facts.audit.ray_count == 64);
    assert_true(facts.audit.error == 0.0078125 && facts.audit.error95 == 0.015625 && facts.audit.tolerance == 0.01);
    assert_string_equal(facts.plan, "a grid of light pays");
    assert_string_equal(facts.method, "midpoint");
    assert_true(facts.step == 0.01 && facts.sampling_error == 0.125 && !facts.is_draft);
    assert_string_equal(facts.sequence_hash, header.sequence_hash);
    close(fd);
    header.audit = (struct audit_result){.kind = AUDIT_REFERENCE, .is_missed = true};
    header.is_draft = true;
    fd = write_image(&image, &header, 1);
    assert_true(image_exr_read(fd, NULL, &facts, 1, NULL));
    assert_true(facts.audit.kind == AUDIT_REFERENCE && !facts.audit.is_pooled);
    assert_true(facts.audit.is_missed && facts.is_draft);
    image_finish(&image);
    close(fd);
}

static void assert_lacks(int fd, const char *const *names)
{
    size_t size;
    char *bytes = read_bytes(fd, &size);

    for (size_t i = 0; names[i]; i++)
        assert_null(memmem(bytes, size, names[i], strlen(names[i])));
    free(bytes);
}

static void a_frame_without_tolerance_says_nothing_of_error(void **state)
{
    struct image image = make_image(5, 4, false, false, 1);
    struct image_exr_header header = make_header(JOB_PIXEL_HALF, JOB_COMPRESSION_ZIP);
    struct image_exr_facts facts;
    static const char *const names[] = {"marchd:error", "marchd:audit",         "marchd:tolerance",
                                        "marchd:plan",  "marchd:samplingError", NULL};
    int fd;

    header.audit = (struct audit_result){0};
    header.sampling_error = 0.0;
    header.plan = "";
    fd = write_image(&image, &header, 1);
    assert_true(image_exr_read(fd, NULL, &facts, 1, NULL));
    assert_int_equal(facts.audit.kind, AUDIT_NONE);
    assert_true(isnan(facts.audit.error) && facts.sampling_error == 0.0);
    assert_string_equal(facts.plan, "");
    assert_lacks(fd, names);
    image_finish(&image);
    close(fd);
}

static void a_scene_without_paths_says_nothing_of_rays(void **state)
{
    struct image image = make_image(5, 4, false, false, 1);
    struct image_exr_header header = make_header(JOB_PIXEL_HALF, JOB_COMPRESSION_ZIP);
    struct image_exr_facts facts = {.rays = {.is_known = true}};
    static const char *const names[] = {"marchd:cut", "marchd:rays", NULL};
    int fd;

    header.rays.is_known = false;
    fd = write_image(&image, &header, 1);
    assert_true(image_exr_read(fd, NULL, &facts, 1, NULL));
    assert_false(facts.rays.is_known);
    assert_lacks(fd, names);
    image_finish(&image);
    close(fd);
}

// `path` names a descriptor of this process for another one, so no file is needed.
static void descriptor_path(int fd, char path[static 64])
{
    snprintf(path, 64, "/proc/%d/fd/%d", (int)getpid(), fd);
}

static void assert_string_attribute(exr_context_t context, const char *name, const char *expected)
{
    const exr_attribute_t *found;

    assert_int_equal(exr_get_attribute_by_name(context, 0, name, &found), EXR_ERR_SUCCESS);
    assert_int_equal(found->type, EXR_ATTR_STRING);
    assert_string_equal(found->string->str, expected);
}

static void standard_attributes_have_their_types_and_values(void **state)
{
    struct image image = make_image(5, 4, true, true, 1);
    struct image_exr_header header = make_header(JOB_PIXEL_HALF, JOB_COMPRESSION_ZIP);
    int fd = write_image(&image, &header, 1);
    const exr_attribute_t *found;
    const exr_attr_chlist_t *channels;
    exr_context_t context;
    char path[64];

    descriptor_path(fd, path);
    assert_int_equal(exr_start_read(&context, path, NULL), EXR_ERR_SUCCESS);
    assert_string_attribute(context, "capDate", "2001:09:09 01:46:40");
    assert_string_attribute(context, "owner", "ada");
    assert_string_attribute(context, "software", "marchd " MARCHD_VERSION);
    assert_string_attribute(context, "marchd:job", "5000000007");
    assert_string_attribute(context, "marchd:method", "midpoint");
    assert_string_attribute(context, "marchd:backend", "osmesa");
    assert_string_attribute(context, "marchd:renderer", "llvmpipe");
    assert_string_attribute(context, "marchd:shaderHash", header.shader_hash);
    assert_int_equal(exr_get_attribute_by_name(context, 0, "marchd:step", &found), EXR_ERR_SUCCESS);
    assert_true(found->type == EXR_ATTR_DOUBLE && found->d == 0.01);
    assert_int_equal(exr_get_attribute_by_name(context, 0, "marchd:attempt", &found), EXR_ERR_SUCCESS);
    assert_true(found->type == EXR_ATTR_INT && found->i == 2);
    assert_int_equal(exr_get_attribute_by_name(context, 0, "framesPerSecond", &found), EXR_ERR_SUCCESS);
    assert_int_equal(found->type, EXR_ATTR_RATIONAL);
    assert_int_equal(found->rational->num, 24000);
    assert_int_equal(found->rational->denom, 1001);
    assert_int_equal(exr_get_attribute_by_name(context, 0, "worldToCamera", &found), EXR_ERR_SUCCESS);
    assert_int_equal(found->type, EXR_ATTR_M44F);
    assert_true(found->m44f->m[3] == 1.5f);
    assert_int_equal(exr_get_attribute_by_name(context, 0, "worldToNDC", &found), EXR_ERR_SUCCESS);
    assert_true(found->m44f->m[12] == -12.0f);
    assert_int_equal(exr_get_attribute_by_name(context, 0, "chromaticities", &found), EXR_ERR_SUCCESS);
    assert_true(found->chromaticities->red_x == 0.64f && found->chromaticities->white_y == 0.329f);
    assert_int_equal(exr_get_channels(context, 0, &channels), EXR_ERR_SUCCESS);
    assert_int_equal(channels->num_channels, 8);
    assert_string_equal(channels->entries[4].name.str, "Z");
    assert_int_equal(channels->entries[4].pixel_type, EXR_PIXEL_FLOAT);
    assert_int_equal(channels->entries[7].pixel_type, EXR_PIXEL_HALF);
    exr_finish(&context);
    image_finish(&image);
    close(fd);
}

// exrheader uses the C++ library, which shares no code with the library that wrote the file.
static void another_library_reads_the_header(void **state)
{
    struct image image = make_image(31, 18, true, true, 1);
    struct image_exr_header header = make_header(JOB_PIXEL_HALF, JOB_COMPRESSION_PIZ);
    int fd;
    char path[64], command[128], text[8192];
    size_t length;
    FILE *pipe;

    if (system("command -v exrheader >/dev/null") != 0) {
        image_finish(&image);
        print_message("exrheader is not installed\n");
        skip();
    }
    fd = write_image(&image, &header, 1);
    descriptor_path(fd, path);
    snprintf(command, sizeof command, "exrheader %s", path);
    pipe = popen(command, "r");
    assert_non_null(pipe);
    length = fread(text, 1, sizeof text - 1, pipe);
    text[length] = '\0';
    assert_int_equal(pclose(pipe), 0);
    assert_non_null(strstr(text, "transmittance.R, 16-bit floating-point"));
    assert_non_null(strstr(text, "Z, 32-bit floating-point"));
    assert_non_null(strstr(text, "dataWindow (type box2i): (0 0) - (30 17)"));
    assert_non_null(strstr(text, "framesPerSecond (type rational): 24000/1001"));
    assert_non_null(strstr(text, "marchd:frame (type int): 42"));
    image_finish(&image);
    close(fd);
}

static void file_cut_anywhere_is_refused_with_a_reason(void **state)
{
    for (int i = 0; i < COMPRESSION_COUNT; i++) {
        struct image image = make_image(17, 33, true, false, 5);
        struct image_exr_header header = make_header(JOB_PIXEL_HALF, compressions[i]);
        int fd = write_image(&image, &header, 1);
        size_t size;
        char *bytes = read_bytes(fd, &size);

        for (size_t length = 0; length < size; length += length < 1200 ? 1 : 17) {
            int cut = memfd_create("cut", MFD_CLOEXEC);
            struct error error = {0};
            struct image found;

            assert_int_equal(write(cut, bytes, length), length);
            if (image_exr_read(cut, &found, NULL, 2, &error))
                fail_msg("read whole with %zu of %zu bytes", length, size);
            assert_null(found.rgba);
            assert_true(error.message[0]);
            close(cut);
        }
        free(bytes);
        image_finish(&image);
        close(fd);
    }
}

static void flipped_byte_is_refused_or_read_but_never_crashes(void **state)
{
    struct random random = {11};

    for (int i = 0; i < COMPRESSION_COUNT; i++) {
        struct image image = make_image(17, 33, true, false, 5);
        struct image_exr_header header = make_header(JOB_PIXEL_HALF, compressions[i]);
        int fd = write_image(&image, &header, 1);
        size_t size;
        char *bytes = read_bytes(fd, &size);

        for (int trial = 0; trial < 1500; trial++) {
            size_t at = trial < 900 ? (size_t)trial : (size_t)random_between(&random, 0, (double)size);
            char flipped = (char)(bytes[at] ^ (char)(int)random_between(&random, 1, 255));
            struct error error = {0};
            struct image found;

            assert_int_equal(pwrite(fd, &flipped, 1, (off_t)at), 1);
            if (image_exr_read(fd, &found, NULL, 1, &error))
                image_finish(&found);
            else
                assert_true(error.message[0]);
            assert_int_equal(pwrite(fd, &bytes[at], 1, (off_t)at), 1);
        }
        free(bytes);
        image_finish(&image);
        close(fd);
    }
}

static void full_disk_is_told_by_errno(void **state)
{
    struct image image = make_image(64, 64, false, false, 1);
    struct image_exr_header header = make_header(JOB_PIXEL_HALF, JOB_COMPRESSION_ZIP);
    struct error error = {0};
    int fd = open("/dev/full", O_RDWR | O_CLOEXEC);

    assert_false(image_exr_write(fd, &image, &header, 2, &error));
    assert_int_equal(errno, ENOSPC);
    assert_non_null(strstr(error.message, "No space left on device"));
    image_finish(&image);
    close(fd);
}

static void value_over_the_largest_half_is_read_back_infinite(void **state)
{
    struct image image = make_image(3, 3, false, false, 1);
    struct image_exr_header header = make_header(JOB_PIXEL_HALF, JOB_COMPRESSION_ZIP);
    struct error error = {0};
    struct image found;
    int fd;

    image.rgba[4 * 4 + 1] = 70000.0f;
    assert_true(image_is_finite(&image, false, NULL));
    assert_false(image_is_finite(&image, true, &error));
    assert_non_null(strstr(error.message, "channel G at pixel (1, 1)"));
    fd = write_image(&image, &header, 1);
    assert_true(image_exr_read(fd, &found, NULL, 1, NULL));
    assert_false(image_is_finite(&found, false, &error));
    assert_non_null(strstr(error.message, "channel G at pixel (1, 1) is infinite"));
    image_finish(&found);
    image_finish(&image);
    close(fd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_compression_and_pixel_type_comes_back_to_the_bit),
        cmocka_unit_test(chunk_that_does_not_shrink_comes_back_to_the_bit),
        cmocka_unit_test(thread_count_does_not_change_the_bytes),
        cmocka_unit_test(facts_are_read_back_without_the_pixels),
        cmocka_unit_test(a_scene_without_paths_says_nothing_of_rays),
        cmocka_unit_test(audit_and_plan_are_read_back),
        cmocka_unit_test(a_frame_without_tolerance_says_nothing_of_error),
        cmocka_unit_test(standard_attributes_have_their_types_and_values),
        cmocka_unit_test(another_library_reads_the_header),
        cmocka_unit_test(file_cut_anywhere_is_refused_with_a_reason),
        cmocka_unit_test(flipped_byte_is_refused_or_read_but_never_crashes),
        cmocka_unit_test(full_disk_is_told_by_errno),
        cmocka_unit_test(value_over_the_largest_half_is_read_back_infinite),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
