// What the modelled orders of scattering leave out, in the header of a file.
// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <OpenEXR/openexr.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

static int write_image(const struct job_beyond *beyond)
{
    const struct image_exr_header header = {.pixel = JOB_PIXEL_HALF,
                                            .compression = JOB_COMPRESSION_ZIP,
                                            .fps_numerator = 24,
                                            .fps_denominator = 1,
                                            .method = "midpoint",
                                            .beyond = *beyond};
    int fd = memfd_create("frame", MFD_CLOEXEC);
    struct error error = {{0}};
    struct image image;

    assert_true(fd >= 0 && image_init(&image, 2, 2, false, false, NULL));
    memset(image.rgba, 0, 16 * sizeof *image.rgba);
    if (!image_exr_write(fd, &image, &header, 1, &error)) fail_msg("%s", error.message);
    image_finish(&image);
    return fd;
}

static void assert_attribute(int fd, const char *name, bool is_there, double number)
{
    const exr_attribute_t *found = NULL;
    exr_context_t context;
    char path[64];

    snprintf(path, sizeof path, "/proc/%d/fd/%d", (int)getpid(), fd);
    assert_int_equal(exr_start_read(&context, path, NULL), EXR_ERR_SUCCESS);
    assert_int_equal(exr_get_attribute_by_name(context, 0, name, &found) == EXR_ERR_SUCCESS, is_there);
    if (is_there) {
        assert_int_equal(found->type, EXR_ATTR_DOUBLE);
        assert_true(found->d == number);
    }
    exr_finish(&context);
}

static void check(const struct job_beyond *beyond, bool is_read)
{
    int fd = write_image(beyond);
    struct error error = {{0}};
    struct image_exr_facts facts;

    assert_attribute(fd, "marchd:beyond", beyond->is_known, beyond->error);
    assert_attribute(fd, "marchd:beyond95", beyond->is_known, beyond->error95);
    if (!image_exr_read(fd, NULL, &facts, 1, &error)) fail_msg("%s", error.message);
    assert_int_equal(facts.beyond.is_known, is_read);
    assert_true(facts.beyond.error == (is_read ? beyond->error : 0.0));
    assert_true(facts.beyond.error95 == (is_read ? beyond->error95 : 0.0));
    close(fd);
}

static void what_is_known_is_written_and_read(void **state)
{
    check(&(struct job_beyond){.is_known = true, .error = 0.65, .error95 = 0.68}, true);
    check(&(struct job_beyond){.is_known = true}, true);
    check(&(struct job_beyond){.why = "a density has no known bound"}, false);
    check(&(struct job_beyond){0}, false);
}

static void numbers_that_cannot_be_are_not_read(void **state)
{
    check(&(struct job_beyond){.is_known = true, .error = 0.5, .error95 = 0.4}, false);
    check(&(struct job_beyond){.is_known = true, .error = 0.5, .error95 = 1.5}, false);
    check(&(struct job_beyond){.is_known = true, .error = -0.5, .error95 = 0.5}, false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_known_is_written_and_read),
        cmocka_unit_test(numbers_that_cannot_be_are_not_read),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
