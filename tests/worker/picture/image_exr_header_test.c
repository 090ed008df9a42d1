// Who made a frame, where and what for: what is written into its header as text.
// SPDX-License-Identifier: Apache-2.0
#include "worker/picture/image.h"
#include "worker/picture/image_exr.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

static void who_where_and_what_for_are_in_the_header(void **state)
{
    static const char *const expected[] = {"owner",       "ada",         "marchd:host", "node7",    "marchd:farm",
                                           "attic",       "marchd:name", "cloud",       "comments", "for the trailer",
                                           "marchd:tags", "a, b",        "marchd:node", "big-7"};
    const struct image_exr_header header = {.fps_numerator = 24,
                                            .fps_denominator = 1,
                                            .owner = "ada",
                                            .host = "node7",
                                            .node = "big-7",
                                            .farm = "attic",
                                            .job_name = "cloud",
                                            .comment = "for the trailer",
                                            .tags = "a, b"};
    struct image_exr_facts facts;
    struct image image;
    char bytes[4096];
    int fd = memfd_create("frame", MFD_CLOEXEC);
    ssize_t size;

    assert_true(image_init(&image, 5, 4, false, false, NULL));
    assert_true(image_exr_write(fd, &image, &header, 1, NULL));
    size = pread(fd, bytes, sizeof bytes, 0);
    assert_true(size > 0);
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++)
        if (!memmem(bytes, (size_t)size, expected[i], strlen(expected[i]))) fail_msg("no %s", expected[i]);
    assert_true(image_exr_read(fd, NULL, &facts, 1, NULL));
    assert_string_equal(facts.job_name, "cloud");
    image_finish(&image);
    close(fd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_where_and_what_for_are_in_the_header),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
