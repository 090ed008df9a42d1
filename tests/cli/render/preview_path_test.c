// SPDX-License-Identifier: Apache-2.0
#include "cli/render/preview_path.h"

#include "core/base/error.h"
#include "tests/support/temp_folder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static void assert_refused(const char *path, const char *expected)
{
    struct error error = {0};

    assert_null(preview_path_check(path, &error));
    if (!strstr(error.message, expected)) fail_msg("%s", error.message);
}

static void only_png_files_are_shown(void **state)
{
    static const char *const names[] = {"live", "live.exr", ".png", "live.png/", "live.png.tmp", ""};

    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        assert_refused(names[i], "--preview: expected NAME.png, got ");
}

static void paths_become_absolute(void **state)
{
    char *folder = realpath(*state, NULL), *path, expected[512];

    assert_int_equal(chdir(*state), 0);
    snprintf(expected, sizeof expected, "%s/live.png", folder);
    path = preview_path_check("live.png", NULL);
    assert_string_equal(path, expected);
    free(path);
    path = preview_path_check("./live.png", NULL);
    assert_string_equal(path, expected);
    free(path);
    path = preview_path_check(expected, NULL);
    assert_string_equal(path, expected);
    free(path);
    assert_int_equal(chdir("/"), 0);
    free(folder);
}

static void file_that_cannot_be_there_is_refused(void **state)
{
    const char *folder = temp_folder_path(state, "folder.png"), *link = temp_folder_path(state, "link.png");

    assert_refused(temp_folder_path(state, "none/live.png"), "none/: No such file or directory");
    assert_int_equal(mkdir(folder, 0777), 0);
    assert_refused(folder, "expected a file");
    assert_int_equal(symlink("elsewhere.png", link), 0); // would be replaced, not followed
    assert_refused(link, "expected a file");
    assert_refused("/proc/live.png", "--preview: cannot write beside /proc/live.png: ");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_png_files_are_shown),
        cmocka_unit_test_setup_teardown(paths_become_absolute, temp_folder_create, temp_folder_destroy),
        cmocka_unit_test_setup_teardown(file_that_cannot_be_there_is_refused, temp_folder_create, temp_folder_destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
