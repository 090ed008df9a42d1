// SPDX-License-Identifier: Apache-2.0
#include "core/scene/input_path.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_format(const char *path, int32_t frame, const char *expected)
{
    char *text = input_path_format(path, frame);

    assert_string_equal(text, expected);
    free(text);
}

static void a_run_is_the_frames_number(void **state)
{
    assert_format("smoke.####.nvdb", 7, "smoke.0007.nvdb");
    assert_format("/a/b/#.nvdb", 1234567, "/a/b/1234567.nvdb");
    assert_format("###", 0, "000");
    assert_format("/a/head.nii.gz", 7, "/a/head.nii.gz");
    assert_true(input_path_is_sequence("a/b.#.nvdb"));
    assert_false(input_path_is_sequence("a/b.nvdb"));
}

static void a_folders_name_holds_no_number(void **state)
{
    assert_format("/C#/v##/smoke.nvdb", 7, "/C#/v##/smoke.nvdb");
    assert_format("/C#/v##/smoke#.nvdb", 7, "/C#/v##/smoke7.nvdb");
    assert_false(input_path_is_sequence("/C#/smoke.nvdb"));
}

static void endings_are_compared_without_case(void **state)
{
    assert_true(input_path_has_ending("/a/HEAD.NII.GZ", ".nii.gz"));
    assert_true(input_path_has_ending("####.raw", ".raw"));
    assert_false(input_path_has_ending("a/.raw", ".raw"));
    assert_false(input_path_has_ending("a.vdb", ".nvdb"));
    assert_false(input_path_has_ending("a.raw/b", ".raw"));
}

static void a_plain_path_has_names_alone(void **state)
{
    assert_true(input_path_is_plain("/a"));
    assert_true(input_path_is_plain("/a/..b/.c/d.."));
    assert_false(input_path_is_plain("/"));
    assert_false(input_path_is_plain("a"));
    assert_false(input_path_is_plain("/a/"));
    assert_false(input_path_is_plain("/a//b"));
    assert_false(input_path_is_plain("/a/./b"));
    assert_false(input_path_is_plain("/../b"));
    assert_false(input_path_is_plain("/a/.."));
}

static void assert_refused(const char *path, const char *expected)
{
    struct error error = {0};

    assert_false(input_path_check(path, &error));
    assert_string_equal(error.message, expected);
}

static void what_names_no_file_is_refused(void **state)
{
    char *longest = xcalloc(1, INPUT_PATH_LIMIT + 2);

    assert_refused("", "expected a file's path");
    assert_refused("a/", "expected a file's path");
    assert_refused("a\nb", "expected a path without control bytes");
    assert_refused("a#b##", "expected one run of # for the frame's number, got two");
    assert_refused("##########", "expected at most 9 # for the frame's number");
    memset(longest, 'a', INPUT_PATH_LIMIT + 1);
    assert_refused(longest, "expected a path of at most 4000 bytes, got 4001");
    longest[INPUT_PATH_LIMIT] = '\0';
    assert_true(input_path_check(longest, NULL));
    assert_true(input_path_check("/C#/#########.nii", NULL));
    free(longest);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_is_the_frames_number),    cmocka_unit_test(a_folders_name_holds_no_number),
        cmocka_unit_test(a_plain_path_has_names_alone),  cmocka_unit_test(endings_are_compared_without_case),
        cmocka_unit_test(what_names_no_file_is_refused),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
