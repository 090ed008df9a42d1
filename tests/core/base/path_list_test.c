// SPDX-License-Identifier: Apache-2.0
#include "core/base/path_list.h"

#include "core/base/alloc.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static void a_path_is_below_whole_components(void **state)
{
    struct path_list list = {0};

    path_list_add(&list, xstrdup("/srv/in"));
    path_list_add(&list, xstrdup("/srv/in/deep"));
    path_list_add(&list, xstrdup("/usr/share"));
    assert_string_equal(path_list_find_root(&list, "/srv/in/a.nvdb"), "/srv/in");
    assert_string_equal(path_list_find_root(&list, "/srv/in/deep/a.nvdb"), "/srv/in");
    assert_string_equal(path_list_find_root(&list, "/usr/share/a/b.nii"), "/usr/share");
    assert_null(path_list_find_root(&list, "/srv/inner/a.nvdb"));
    assert_null(path_list_find_root(&list, "/srv/in"));
    assert_null(path_list_find_root(&list, "/srv/in/"));
    assert_null(path_list_find_root(&list, "srv/in/a.nvdb"));
    path_list_finish(&list);
    assert_null(path_list_find_root(&list, "/srv/in/a.nvdb"));
}

static void all_is_below_the_root_of_all(void **state)
{
    struct path_list list = {0};

    path_list_add(&list, xstrdup("/"));
    assert_string_equal(path_list_find_root(&list, "/a"), "/");
    assert_string_equal(path_list_find_root(&list, "/home/ann/a.nvdb"), "/");
    assert_null(path_list_find_root(&list, "/"));
    assert_null(path_list_find_root(&list, "a"));
    path_list_finish(&list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_path_is_below_whole_components),
        cmocka_unit_test(all_is_below_the_root_of_all),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
