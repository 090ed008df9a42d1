// SPDX-License-Identifier: Apache-2.0
#include "core/base/file.h"

#include "core/base/error.h"
#include "tests/support/temp_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <sys/stat.h>

#include <cmocka.h>

static int count_entries(const char *folder)
{
    DIR *entries = opendir(folder);
    int count = 0;

    assert_non_null(entries);
    while (readdir(entries))
        count++;
    closedir(entries);
    return count - 2;
}

static void written_file_reads_back(void **state)
{
    const char *path = temp_folder_path(state, "a.txt");
    char *text;
    size_t length;

    assert_true(file_write_atomic(path, "one\0two", 7, NULL));
    assert_true(file_read_text(path, 7, &text, &length, NULL));
    assert_int_equal(length, 7);
    assert_memory_equal(text, "one\0two", 8);
    free(text);
    assert_true(file_write_atomic(path, "", 0, NULL));
    assert_true(file_read_text(path, 0, &text, NULL, NULL));
    assert_string_equal(text, "");
    free(text);
    assert_int_equal(count_entries(*state), 1);
}

static void large_file_reads_back(void **state)
{
    const char *path = temp_folder_path(state, "large");
    size_t size = 3 * 1000 * 1000, length;
    char *bytes = malloc(size), *text;

    assert_non_null(bytes);
    for (size_t i = 0; i < size; i++)
        bytes[i] = (char)(i * 7 % 251);
    assert_true(file_write_atomic(path, bytes, size, NULL));
    assert_true(file_read_text(path, size, &text, &length, NULL));
    assert_int_equal(length, size);
    assert_memory_equal(text, bytes, size);
    free(text);
    free(bytes);
}

static void file_over_the_limit_is_refused_with_both_sizes(void **state)
{
    const char *path = temp_folder_path(state, "a.txt");
    struct error error = {0};
    char *text = NULL;
    size_t length = 1;

    assert_true(file_write_atomic(path, "12345", 5, NULL));
    assert_false(file_read_text(path, 4, &text, &length, &error));
    assert_string_equal(error.message, "5 bytes are more than the 4 allowed");
    assert_null(text);
    assert_int_equal(length, 0);
}

static void endless_file_is_refused(void **state)
{
    struct error error = {0};
    char *text;

    assert_false(file_read_text("/dev/zero", 100000, &text, NULL, &error));
    assert_string_equal(error.message, "larger than the 100000 bytes allowed");
    assert_null(text);
}

static void missing_file_and_folder_are_errors(void **state)
{
    struct error error = {0};
    char *text;

    assert_false(file_read_text(temp_folder_path(state, "none"), 10, &text, NULL, &error));
    assert_string_equal(error.message, "cannot open: No such file or directory");
    assert_false(file_read_text(*state, 10000, &text, NULL, &error));
    assert_string_equal(error.message, "cannot read: Is a directory");
    assert_null(text);
}

static void failed_write_leaves_nothing_behind(void **state)
{
    const char *folder = temp_folder_path(state, "folder");
    struct error error = {0};

    assert_int_equal(mkdir(folder, 0700), 0);
    assert_false(file_write_atomic(folder, "x", 1, &error));
    assert_non_null(strstr(error.message, "Is a directory"));
    assert_int_equal(count_entries(*state), 1);
    assert_false(file_write_atomic(temp_folder_path(state, "none/a.txt"), "x", 1, &error));
    assert_non_null(strstr(error.message, "No such file or directory"));
}

static void full_disk_is_an_error(void **state)
{
    int fd = open("/dev/full", O_WRONLY);
    struct error error = {0};

    if (fd < 0) {
        puts("skipped: no /dev/full here");
        skip();
    }
    assert_false(file_write_all(fd, "x", 1, &error));
    assert_string_equal(error.message, "cannot write: No space left on device");
    close(fd);
}

static void all_that_is_written_arrives(void **state)
{
    int fds[2];
    char bytes[6] = "";

    assert_int_equal(pipe(fds), 0);
    assert_true(file_write_all(fds[1], "abc", 3, NULL));
    assert_true(file_write_all(fds[1], "de", 2, NULL));
    close(fds[1]);
    assert_int_equal(read(fds[0], bytes, sizeof bytes), 5);
    assert_string_equal(bytes, "abcde");
    close(fds[0]);
}

int main(void)
{
#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, temp_folder_create, temp_folder_destroy)
    const struct CMUnitTest tests[] = {
        WITH_FOLDER(written_file_reads_back),
        WITH_FOLDER(large_file_reads_back),
        WITH_FOLDER(file_over_the_limit_is_refused_with_both_sizes),
        WITH_FOLDER(missing_file_and_folder_are_errors),
        WITH_FOLDER(failed_write_leaves_nothing_behind),
        cmocka_unit_test(endless_file_is_refused),
        cmocka_unit_test(full_disk_is_an_error),
        cmocka_unit_test(all_that_is_written_arrives),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
