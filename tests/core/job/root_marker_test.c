// SPDX-License-Identifier: Apache-2.0
#include "core/job/root_marker.h"

#include "core/base/error.h"
#include "tests/support/temp_folder.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/stat.h>

#include <cmocka.h>

static const char first_id[] = "00112233445566778899aabbccddeeff";
static const char other_id[] = "ffeeddccbbaa99887766554433221100";

static int open_root(void *const *state)
{
    int fd = open(*state, O_PATH | O_DIRECTORY | O_CLOEXEC);

    assert_true(fd >= 0);
    return fd;
}

static void write_marker(void *const *state, const char *text, size_t size)
{
    FILE *file = fopen(temp_folder_path(state, ROOT_MARKER_NAME), "w");

    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void expect_marker(int root_fd, enum root_marker_state wanted, const char *wanted_id)
{
    char id[ROOT_MARKER_ID_SIZE];

    assert_int_equal(root_marker_read(root_fd, id, NULL), wanted);
    assert_string_equal(id, wanted_id);
}

static void first_id_of_a_root_counts(void **state)
{
    int root_fd = open_root(state);

    expect_marker(root_fd, ROOT_MARKER_NONE, "");
    assert_true(root_marker_add_root(root_fd, first_id, NULL));
    assert_true(root_marker_add_root(root_fd, other_id, NULL));
    expect_marker(root_fd, ROOT_MARKER_VALID, first_id);
    close(root_fd);
}

static void marker_without_a_whole_id_is_empty_and_can_be_filled(void **state)
{
    static const char torn[] = "# x\0\0\0\nroot 0011\nroot 00112233445566778899aabbccddeeff";
    int root_fd = open_root(state);

    write_marker(state, "", 0);
    expect_marker(root_fd, ROOT_MARKER_EMPTY, "");
    write_marker(state, torn, sizeof torn - 1); // no line's end after the id
    expect_marker(root_fd, ROOT_MARKER_EMPTY, "");
    assert_true(root_marker_add_root(root_fd, other_id, NULL));
    expect_marker(root_fd, ROOT_MARKER_VALID, first_id);
    close(root_fd);
}

static void marker_that_is_no_file_is_unknown(void **state)
{
    int root_fd = open_root(state);
    struct error error = {0};
    char id[ROOT_MARKER_ID_SIZE];

    assert_int_equal(symlink("elsewhere", temp_folder_path(state, ROOT_MARKER_NAME)), 0);
    assert_int_equal(root_marker_read(root_fd, id, &error), ROOT_MARKER_UNKNOWN);
    assert_string_equal(error.message, "has a .marchd-root that is a link or no file: put the file back");
    assert_false(root_marker_add_root(root_fd, first_id, NULL));
    assert_int_equal(unlink(temp_folder_path(state, ROOT_MARKER_NAME)), 0);
    assert_int_equal(mkfifo(temp_folder_path(state, ROOT_MARKER_NAME), 0600), 0);
    expect_marker(root_fd, ROOT_MARKER_UNKNOWN, "");
    close(root_fd);
}

static void farms_are_found_by_where_their_store_lies(void **state)
{
    int root_fd = open_root(state);
    char farm[ROOT_MARKER_ID_SIZE];

    assert_false(root_marker_find_farm(*state, "/var/lib/marchd", farm));
    assert_true(root_marker_add_root(root_fd, first_id, NULL));
    assert_true(root_marker_add_farm(root_fd, first_id, "/var/lib/marchd", NULL));
    assert_true(root_marker_add_farm(root_fd, other_id, "/home/ann/a state", NULL));
    assert_true(root_marker_find_farm(*state, "/var/lib/marchd", farm));
    assert_string_equal(farm, first_id);
    assert_true(root_marker_find_farm(*state, "/home/ann/a state", farm));
    assert_string_equal(farm, other_id);
    assert_false(root_marker_find_farm(*state, "/var/lib/marchd2", farm));
    assert_true(root_marker_add_farm(root_fd, other_id, "/var/lib/marchd", NULL));
    assert_true(root_marker_find_farm(*state, "/var/lib/marchd", farm));
    assert_string_equal(farm, other_id);
    close(root_fd);
}

static void line_of_a_farm_is_added_once(void **state)
{
    int root_fd = open_root(state);
    struct stat before, after;

    assert_true(root_marker_add_farm(root_fd, first_id, "/var/lib/marchd", NULL));
    assert_int_equal(stat(temp_folder_path(state, ROOT_MARKER_NAME), &before), 0);
    assert_true(root_marker_add_farm(root_fd, first_id, "/var/lib/marchd", NULL));
    assert_int_equal(stat(temp_folder_path(state, ROOT_MARKER_NAME), &after), 0);
    assert_int_equal(before.st_size, after.st_size);
    close(root_fd);
}

static void made_ids_differ(void **state)
{
    char a[ROOT_MARKER_ID_SIZE], b[ROOT_MARKER_ID_SIZE];

    root_marker_make_id(a);
    root_marker_make_id(b);
    assert_true(root_marker_is_id(a));
    assert_string_not_equal(a, b);
    assert_false(root_marker_is_id("0011223344556677"));
    assert_false(root_marker_is_id("00112233445566778899AABBCCDDEEFF"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(first_id_of_a_root_counts, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(marker_without_a_whole_id_is_empty_and_can_be_filled, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(marker_that_is_no_file_is_unknown, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(farms_are_found_by_where_their_store_lies, temp_folder_create,
                                        temp_folder_destroy),
        cmocka_unit_test_setup_teardown(line_of_a_farm_is_added_once, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(made_ids_differ),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
