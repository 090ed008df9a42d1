// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_memory.h"

#include "core/base/error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/volume_maker.h"

#include <setjmp.h>
#include <stdarg.h>
#include <sys/stat.h>

#include <cmocka.h>

static void write_limit(void **state, const char *folder, const char *file, const char *text)
{
    char path[100];

    mkdir(temp_folder_path(state, folder), 0777);
    snprintf(path, sizeof path, "%s/%s", folder, file);
    volume_maker_write(temp_folder_path(state, path), text, strlen(text));
}

static void least_limit_of_a_group_and_those_above_it(void **state)
{
    write_limit(state, "farm", "memory.max", "3000000000\n");
    write_limit(state, "farm/job", "memory.max", "max\n");
    write_limit(state, "other", "memory.max", "5\n");
    assert_int_equal(volume_memory_group_limit("0::/farm/job\n", *state), 3000000000);
    assert_int_equal(volume_memory_group_limit("0::/farm\n", *state), 3000000000);
    assert_int_equal(volume_memory_group_limit("0::/gone/job\n", *state), INT64_MAX);
    write_limit(state, "farm/job", "memory.max", "2000000000\n");
    assert_int_equal(volume_memory_group_limit("0::/farm/job\n", *state), 2000000000);
    write_limit(state, ".", "memory.max", "1000000000\n");
    assert_int_equal(volume_memory_group_limit("0::/\n", *state), 1000000000);
    assert_int_equal(volume_memory_group_limit("0::/farm/job\n", *state), 1000000000);
    unlink(temp_folder_path(state, "memory.max"));
}

static void both_versions_of_groups_count(void **state)
{
    mkdir(temp_folder_path(state, "memory"), 0777);
    write_limit(state, "memory/old", "memory.limit_in_bytes", "700\n");
    assert_int_equal(volume_memory_group_limit("9:cpu:/\n4:memory:/old\n0::/\n", *state), 700);
    assert_int_equal(volume_memory_group_limit("4:cpu:/old\n", *state), INT64_MAX);
    assert_int_equal(volume_memory_group_limit("", *state), INT64_MAX);
}

static void too_large_is_refused_with_both_numbers(void **state)
{
    struct error error = {0};

    assert_true(volume_memory_check(1 << 30, 1 << 30, &error));
    assert_false(volume_memory_check(INT64_C(3) << 30, INT64_C(3) << 29, &error));
    assert_string_equal(error.message, "needs 3 GiB of memory, 1.5 GiB are available");
    assert_true(volume_memory_limit() > 1 << 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(least_limit_of_a_group_and_those_above_it),
        cmocka_unit_test(both_versions_of_groups_count),
        cmocka_unit_test(too_large_is_refused_with_both_numbers),
    };

    return cmocka_run_group_tests(tests, temp_folder_create, temp_folder_destroy);
}
