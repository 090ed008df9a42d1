// SPDX-License-Identifier: Apache-2.0
#include "core/base/hash.h"

#include "core/base/error.h"
#include "core/base/file.h"
#include "tests/support/temp_folder.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

static void hash_is_xxh3_in_canonical_order(void **state)
{
    char text[HASH_TEXT_SIZE];

    // XXH3_128bits of no bytes with seed 0, from the test vectors of xxHash.
    hash_bytes("", 0, text);
    assert_string_equal(text, "99aa06d3014798d86001c324468d497f");
}

static void other_bytes_have_another_hash(void **state)
{
    char a[HASH_TEXT_SIZE], b[HASH_TEXT_SIZE];

    hash_bytes("cloud", 5, a);
    hash_bytes("cloue", 5, b);
    assert_int_equal(strlen(a), HASH_TEXT_SIZE - 1);
    assert_int_equal(strspn(a, "0123456789abcdef"), HASH_TEXT_SIZE - 1);
    assert_string_not_equal(a, b);
}

static void file_has_the_hash_of_its_bytes_wherever_it_is_read(void **state)
{
    const char *path = temp_folder_path(state, "bytes");
    size_t size = 1000 * 1000 + 1;
    char *bytes = malloc(size);
    char expected[HASH_TEXT_SIZE], text[HASH_TEXT_SIZE];
    uint64_t size_bytes = 0;
    int fd;

    assert_non_null(bytes);
    for (size_t i = 0; i < size; i++)
        bytes[i] = (char)(i * i % 253);
    assert_true(file_write_atomic(path, bytes, size, NULL));
    fd = open(path, O_RDONLY);
    assert_int_equal(lseek(fd, 1000, SEEK_SET), 1000);
    hash_bytes(bytes, size, expected);
    assert_true(hash_file(fd, text, &size_bytes, NULL));
    assert_string_equal(text, expected);
    assert_int_equal(size_bytes, size);
    close(fd);
    free(bytes);
}

static void file_that_cannot_be_read_is_an_error(void **state)
{
    char text[HASH_TEXT_SIZE];
    struct error error = {0};

    assert_false(hash_file(-1, text, NULL, &error));
    assert_string_equal(error.message, "cannot read: Bad file descriptor");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hash_is_xxh3_in_canonical_order),
        cmocka_unit_test(other_bytes_have_another_hash),
        cmocka_unit_test_setup_teardown(file_has_the_hash_of_its_bytes_wherever_it_is_read, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test(file_that_cannot_be_read_is_an_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
