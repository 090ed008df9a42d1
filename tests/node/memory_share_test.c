// SPDX-License-Identifier: Apache-2.0
#include "node/memory_share.h"

#include "core/base/file.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/stat.h>

#include <cmocka.h>

enum { MIB = 1 << 20 };

static void make_group(void **state, const char *name, const char *limit)
{
    char file[64];

    assert_int_equal(mkdir(temp_folder_path(state, name), 0700), 0);
    snprintf(file, sizeof file, "%s/memory.max", name);
    assert_true(file_write_atomic(temp_folder_path(state, file), limit, strlen(limit), NULL));
}

static int64_t find(void **state, const char *membership)
{
    return memory_share_find_limit(membership, *state);
}

static void the_least_limit_of_all_groups_counts(void **state)
{
    make_group(state, "a", "3145728\n");
    make_group(state, "a/b", "1048576\n");
    make_group(state, "a/b/c", "max\n");
    make_group(state, "a/b/c/d", "2097152\n");
    assert_int_equal(find(state, "0::/a/b/c/d\n"), 1 * MIB);
    assert_int_equal(find(state, "0::/a/b/c\n"), 1 * MIB);
    assert_int_equal(find(state, "0::/a\n"), 3 * MIB);
}

// In a container's namespace its group is the outermost one, and has a limit.
static void the_outermost_group_may_have_a_limit(void **state)
{
    make_group(state, "a", "max\n");
    assert_true(find(state, "0::/a\n") == INT64_MAX);
    assert_true(file_write_atomic(temp_folder_path(state, "memory.max"), "2097152\n", 8, NULL));
    assert_int_equal(find(state, "0::/a\n"), 2 * MIB);
    assert_int_equal(find(state, "0::/\n"), 2 * MIB);
    assert_int_equal(find(state, "0::/../elsewhere\n"), 2 * MIB);
}

static void groups_of_version_1_count_for_nothing(void **state)
{
    make_group(state, "a", "1048576\n");
    assert_true(find(state, "4:memory:/a\n1:name=systemd:/a\n") == INT64_MAX);
    assert_true(find(state, "") == INT64_MAX);
    assert_int_equal(find(state, "4:memory:/b\n0::/a\n"), 1 * MIB);
}

static void the_machine_itself_is_a_limit(void **state)
{
    int64_t pages = sysconf(_SC_PHYS_PAGES), page_bytes = sysconf(_SC_PAGESIZE);

    assert_true(memory_share_find() > 0);
    assert_true(memory_share_find() < pages * page_bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_least_limit_of_all_groups_counts, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(the_outermost_group_may_have_a_limit, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(groups_of_version_1_count_for_nothing, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test(the_machine_itself_is_a_limit),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
