// SPDX-License-Identifier: Apache-2.0
#include "core/scene/file_format.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

static void a_format_is_found_by_the_whole_ending(void **state)
{
    assert_string_equal(file_format_find("/a/HEAD.NII.GZ")->ending, ".nii.gz");
    assert_string_equal(file_format_find("a.vdb")->ending, ".vdb");
    assert_string_equal(file_format_find("a.####.nvdb")->ending, ".nvdb");
    assert_null(file_format_find("a.gz"));
    assert_null(file_format_find("a/.raw"));
    assert_null(file_format_find("a.png/b"));
}

static void contents_are_told_apart(void **state)
{
    assert_true(file_format_is("a.raw", FILE_GRID_RAW));
    assert_true(file_format_is("a.nii", FILE_GRID_RAW | FILE_GRID_DENSE));
    assert_false(file_format_is("a.nii", FILE_GRID_RAW | FILE_GRID_SPARSE));
    assert_false(file_format_is("a.png", FILE_GRID_RAW | FILE_GRID_DENSE | FILE_GRID_SPARSE));
    assert_true(file_format_find("a.exr")->is_linear);
    assert_false(file_format_find("a.png")->is_linear);
    assert_true(file_format_find("a.vdb")->needs_converter);
    assert_false(file_format_find("a.nvdb")->needs_converter);
}

static void assert_listed(unsigned contents, const char *word, const char *expected)
{
    char *list = file_format_list_endings(contents, word);

    assert_string_equal(list, expected);
    free(list);
}

static void endings_are_listed_for_messages(void **state)
{
    assert_listed(FILE_GRID_RAW, "or", ".raw");
    assert_listed(FILE_GRID_SPARSE, "and", ".nvdb and .vdb");
    assert_listed(FILE_IMAGE, "or", ".png or .exr");
    assert_listed(FILE_GRID_RAW | FILE_GRID_DENSE, "or", ".raw, .nrrd, .nhdr, .nii or .nii.gz");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_format_is_found_by_the_whole_ending),
        cmocka_unit_test(contents_are_told_apart),
        cmocka_unit_test(endings_are_listed_for_messages),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
