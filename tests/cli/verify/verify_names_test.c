// SPDX-License-Identifier: Apache-2.0
#include "cli/verify/verify_names.h"

#include "cli/verify/verify_list.h"
#include "core/base/alloc.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// header_frame -1: the header is unknown.
static void add(struct verify_list *list, const char *name, int32_t header_frame)
{
    struct verify_file file = {.name = xstrdup(name), .frame = -1};

    if (header_frame >= 0) {
        file.is_known = true;
        file.header_frame = header_frame;
        snprintf(file.picture_hash, sizeof file.picture_hash, "1");
    }
    list->files = xgrow(list->files, &list->capacity, list->count + 1, sizeof *list->files);
    list->files[list->count++] = file;
}

static const struct verify_file *find(const struct verify_list *list, const char *name)
{
    for (size_t i = 0; i < list->count; i++)
        if (!strcmp(list->files[i].name, name)) return &list->files[i];
    fail_msg("%s is gone", name);
    return NULL;
}

static void files_that_differ_in_their_number_are_one_sequence(void **state)
{
    struct verify_list list = {0};

    add(&list, "b.0001.exr", 1);
    add(&list, "a.0010.exr", 10);
    add(&list, "a.10000.exr", 10000);
    add(&list, "a.0002.exr", 2);
    assert_int_equal(verify_names_sort(&list), 2);
    assert_string_equal(list.files[0].name, "a.0002.exr");
    assert_string_equal(list.files[1].name, "a.0010.exr");
    assert_int_equal(list.files[2].frame, 10000);
    assert_int_equal(list.files[2].sequence, 0);
    assert_int_equal(list.files[3].sequence, 1);
    assert_int_equal(list.files[3].digits_start, 2);
    assert_int_equal(list.files[3].digit_count, 4);
    verify_list_finish(&list);
}

// Without headers it is the number in which most names differ, and in a tie the last one.
static void number_is_where_most_names_have_one(void **state)
{
    struct verify_list list = {0};

    for (int frame = 0; frame < 4; frame++) {
        char name[32];

        snprintf(name, sizeof name, "s%d_v2.exr", frame);
        add(&list, name, -1);
    }
    add(&list, "c7_v3.exr", -1);
    assert_int_equal(verify_names_sort(&list), 2);
    assert_int_equal(find(&list, "s3_v2.exr")->frame, 3);
    assert_int_equal(find(&list, "c7_v3.exr")->frame, 3);
    verify_list_finish(&list);
}

// Ten shots of one frame differ in the number of the shot; the header has the frame's.
static void header_says_which_number_is_the_frame(void **state)
{
    struct verify_list list = {0};

    for (int shot = 0; shot < 10; shot++) {
        char name[32];

        snprintf(name, sizeof name, "s%d.0042.exr", shot);
        add(&list, name, 42);
    }
    assert_int_equal(verify_names_sort(&list), 10);
    for (size_t i = 0; i < list.count; i++)
        assert_int_equal(list.files[i].frame, 42);
    verify_list_finish(&list);
}

static void names_without_a_usable_number_stand_alone(void **state)
{
    struct verify_list list = {0};

    add(&list, "still.exr", 0);
    add(&list, "n99999999999.exr", 1);
    assert_int_equal(verify_names_sort(&list), 2);
    assert_int_equal(list.files[0].frame, -1);
    assert_int_equal(list.files[1].frame, -1);
    assert_int_equal(list.files[1].digit_count, 0);
    verify_list_finish(&list);
    assert_int_equal(verify_names_sort(&list), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_that_differ_in_their_number_are_one_sequence),
        cmocka_unit_test(number_is_where_most_names_have_one),
        cmocka_unit_test(header_says_which_number_is_the_frame),
        cmocka_unit_test(names_without_a_usable_number_stand_alone),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
