// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/picture_version.h"

#include "tests/support/picture_header.h"
#include "tests/support/temp_folder.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static const char hash[] = "00112233445566778899aabbccddeeff";

static void a_header_names_its_job(void **state)
{
    uint8_t bytes[PICTURE_HEADER_SIZE];
    size_t size = picture_header_write(bytes, hash, false);
    struct picture_version version;

    assert_true(picture_version_parse(&version, bytes, size));
    assert_string_equal(version.hash, hash);
    assert_false(version.is_draft);
    size = picture_header_write(bytes, hash, true);
    assert_true(picture_version_parse(&version, bytes, size));
    assert_true(version.is_draft);
}

static void a_header_may_end_anywhere(void **state)
{
    uint8_t bytes[PICTURE_HEADER_SIZE];
    size_t size = picture_header_write(bytes, hash, true);
    struct picture_version version;

    for (size_t length = 0; length < size; length++) {
        uint8_t *part = malloc(length + 1); // sanitizers see its end

        memcpy(part, bytes, length);
        if (picture_version_parse(&version, part, length)) assert_string_equal(version.hash, hash);
        free(part);
    }
}

static void other_files_name_no_job(void **state)
{
    uint8_t bytes[PICTURE_HEADER_SIZE];
    size_t size = picture_header_write(bytes, NULL, false);
    struct picture_version version;

    assert_false(picture_version_parse(&version, bytes, size));
    assert_false(picture_version_parse(&version, (const uint8_t *)"a text, no picture", 18));
    picture_header_write(bytes, hash, false);
    bytes[0]++;
    assert_false(picture_version_parse(&version, bytes, size));
}

// A pipe would have the thread wait that opens it, and a link leads out of the root.
static void only_ordinary_files_are_opened(void **state)
{
    uint8_t bytes[PICTURE_HEADER_SIZE];
    size_t size = picture_header_write(bytes, hash, false);
    int folder = open(*state, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    int file = openat(folder, "picture", O_WRONLY | O_CREAT, 0600);
    struct picture_version version;

    assert_int_equal(write(file, bytes, size), size);
    close(file);
    assert_int_equal(mkfifoat(folder, "pipe", 0600), 0);
    assert_int_equal(symlinkat("picture", folder, "link"), 0);
    assert_true(picture_version_read(&version, folder, "picture"));
    assert_string_equal(version.hash, hash);
    assert_false(picture_version_read(&version, folder, "pipe"));
    assert_false(picture_version_read(&version, folder, "link"));
    assert_false(picture_version_read(&version, folder, "none"));
    close(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_header_names_its_job),
        cmocka_unit_test(a_header_may_end_anywhere),
        cmocka_unit_test(other_files_name_no_job),
        cmocka_unit_test_setup_teardown(only_ordinary_files_are_opened, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
