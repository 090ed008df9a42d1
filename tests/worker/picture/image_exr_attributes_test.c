// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image_exr_attributes.h"

#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

// What is read from the header of a file that is written with `header`; `bytes` is the file's begin.
static struct image_exr_facts read_back(const struct image_exr_header *header, char bytes[static 4096])
{
    struct error error = {0};
    struct image image = {0};
    struct image_exr_facts facts = {0};
    int fd = memfd_create("frame", MFD_CLOEXEC);

    assert_true(fd >= 0);
    assert_true(image_init(&image, 4, 4, false, false, NULL));
    for (int i = 0; i < 4 * 16; i++)
        image.rgba[i] = 0.5f;
    if (!image_exr_write(fd, &image, header, 1, &error) || !image_exr_read(fd, NULL, &facts, 1, &error))
        fail_msg("%s", error.message);
    memset(bytes, 0, 4096);
    assert_true(pread(fd, bytes, 4096, 0) > 0);
    image_finish(&image);
    close(fd);
    return facts;
}

static struct image_exr_header make_header(double traced)
{
    return (struct image_exr_header){.fps_numerator = 24,
                                     .fps_denominator = 1,
                                     .job_hash = "",
                                     .sequence_hash = "",
                                     .method = "cached",
                                     .backend = "osmesa",
                                     .renderer = "llvmpipe",
                                     .shader_hash = "",
                                     .traced = traced};
}

static void the_share_of_traced_pixels_is_read_back(void **state)
{
    struct image_exr_header header = make_header(0.0625);
    char bytes[4096];
    struct image_exr_facts facts = read_back(&header, bytes);

    assert_non_null(memmem(bytes, sizeof bytes, "marchd:traced\0double", sizeof "marchd:traced\0double"));
    assert_true(facts.traced == 0.0625);
    header.traced = 1.0;
    facts = read_back(&header, bytes);
    assert_true(facts.traced == 1.0);
}

static void a_frame_without_interpolated_pixels_says_nothing_of_traced_ones(void **state)
{
    struct image_exr_header header = make_header(0.0);
    char bytes[4096];
    struct image_exr_facts facts = read_back(&header, bytes);

    assert_null(memmem(bytes, sizeof bytes, "marchd:traced", sizeof "marchd:traced"));
    assert_true(facts.traced == 0.0);
}

static void what_is_no_share_is_not_taken_for_one(void **state)
{
    struct image_exr_header header = make_header(1.0625);
    char bytes[4096];

    assert_true(read_back(&header, bytes).traced == 0.0);
    header.traced = INFINITY;
    assert_true(read_back(&header, bytes).traced == 0.0);
}

static void a_files_accuracy_is_all_that_its_header_has(void **state)
{
    struct image_exr_header header = make_header(0.0625);
    char bytes[4096];
    struct image_exr_facts facts;
    struct frame_accuracy accuracy;

    header.audit = (struct audit_result){
        .kind = AUDIT_REFERENCE, .error = 0.0078125, .error95 = 0.015625, .ray_count = 64, .tolerance = 0.01};
    header.plan = "a grid of light pays";
    header.plan_number = 7;
    header.quality = "{}";
    header.rays = (struct image_exr_rays){.is_known = true, .cut_share = 0.125};
    facts = read_back(&header, bytes);
    accuracy = image_exr_accuracy(&facts);
    assert_string_equal(accuracy.audit, "reference");
    assert_string_equal(accuracy.method, "cached");
    assert_true(accuracy.error == 0.0078125 && accuracy.error95 == 0.015625 && accuracy.audit_rays == 64);
    assert_int_equal(accuracy.plan, 7);
    assert_true(accuracy.has_cut_share && accuracy.cut_share == 0.125);
    assert_true(accuracy.traced == 0.0625);
    header.rays.is_known = false;
    facts = read_back(&header, bytes);
    assert_false(image_exr_accuracy(&facts).has_cut_share);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_share_of_traced_pixels_is_read_back),
        cmocka_unit_test(a_frame_without_interpolated_pixels_says_nothing_of_traced_ones),
        cmocka_unit_test(what_is_no_share_is_not_taken_for_one),
        cmocka_unit_test(a_files_accuracy_is_all_that_its_header_has),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
