// SPDX-License-Identifier: Apache-2.0
#include "cli/film/sequence.h"

#include "core/base/error.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[] = "/tmp/sequence_test.XXXXXX";

static void path_of(char path[static 256], const char *name)
{
    snprintf(path, 256, "%s/%s", folder, name);
}

static const char *const names[] = {"a.0010.exr", "a.0002.exr",      "a.0001.exr",
                                    "b.0001.exr", "a.0003.exr.part", "one.exr"};

static int set_up(void **state)
{
    if (!mkdtemp(folder)) return -1;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[256];
        FILE *file;

        path_of(path, names[i]);
        file = fopen(path, "w");
        if (!file) return -1;
        fclose(file);
    }
    return 0;
}

static int tear_down(void **state)
{
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[256];

        path_of(path, names[i]);
        unlink(path);
    }
    return rmdir(folder);
}

static void pattern_finds_its_files_by_number(void **state)
{
    struct sequence sequence = {0};
    char pattern[256], expected[256];

    path_of(pattern, "a.####.exr");
    path_of(expected, "a.0002.exr");
    assert_true(sequence_add(&sequence, pattern, NULL, NULL));
    assert_int_equal(sequence.count, 3);
    assert_int_equal(sequence.files[0].frame, 1);
    assert_string_equal(sequence.files[1].path, expected);
    assert_string_equal(sequence.files[2].label, "10");
    sequence_finish(&sequence);
}

static void range_keeps_only_its_frames(void **state)
{
    struct sequence sequence = {0};
    char pattern[256];

    path_of(pattern, "a.%04d.exr");
    assert_true(sequence_add(&sequence, pattern, "2-10", NULL));
    assert_int_equal(sequence.count, 2);
    assert_int_equal(sequence.files[0].frame, 2);
    sequence_finish(&sequence);
}

static void a_folder_is_its_only_sequence(void **state)
{
    struct sequence sequence = {0};
    struct error error = {0};
    char path[256];

    assert_false(sequence_add(&sequence, folder, NULL, &error));
    assert_non_null(strstr(error.message, "there are several sequences, "));
    path_of(path, "b.0001.exr");
    unlink(path);
    assert_true(sequence_add(&sequence, folder, NULL, NULL));
    assert_int_equal(sequence.count, 3);
    assert_int_equal(sequence.files[2].frame, 10);
    assert_true(sequence_add(&sequence, folder, "2", NULL));
    assert_int_equal(sequence.count, 4);
    assert_false(sequence_add(&sequence, folder, "7-9", &error));
    assert_non_null(strstr(error.message, "none of its files is one of the frames 7-9"));
    assert_false(sequence_add(&sequence, "/proc/self", NULL, &error));
    assert_string_equal(error.message, "/proc/self: there is no sequence of EXR files");
    fclose(fopen(path, "w"));
    sequence_finish(&sequence);
}

static void files_are_taken_as_they_come(void **state)
{
    struct sequence sequence = {0};
    char path[256];

    path_of(path, "one.exr");
    assert_true(sequence_add(&sequence, path, NULL, NULL));
    path_of(path, "b.0001.exr");
    assert_true(sequence_add(&sequence, path, NULL, NULL));
    assert_int_equal(sequence.count, 2);
    assert_string_equal(sequence.files[0].label, "one.exr");
    assert_string_equal(sequence.files[1].path, path);
    sequence_finish(&sequence);
}

static void nothing_found_is_an_error_that_names_the_operand(void **state)
{
    struct sequence sequence = {0};
    struct error error = {0};
    char pattern[256];

    path_of(pattern, "c.####.exr");
    assert_false(sequence_add(&sequence, pattern, NULL, &error));
    assert_non_null(strstr(error.message, "c.####.exr: no such files"));
    path_of(pattern, "c.exr");
    assert_false(sequence_add(&sequence, pattern, NULL, &error));
    assert_non_null(strstr(error.message, "c.exr: No such file"));
    sequence_finish(&sequence);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pattern_finds_its_files_by_number),
        cmocka_unit_test(range_keeps_only_its_frames),
        cmocka_unit_test(a_folder_is_its_only_sequence),
        cmocka_unit_test(files_are_taken_as_they_come),
        cmocka_unit_test(nothing_found_is_an_error_that_names_the_operand),
    };

    return cmocka_run_group_tests(tests, set_up, tear_down);
}
