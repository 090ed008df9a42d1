// SPDX-License-Identifier: Apache-2.0
#include "cli/verify/verify_sequence.h"

#include "cli/verify/verify_list.h"
#include "core/base/alloc.h"
#include "core/job/frame_range.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static struct verify_file *add(struct verify_list *list, int32_t frame)
{
    struct verify_file *file;

    list->files = xgrow(list->files, &list->capacity, list->count + 1, sizeof *list->files);
    file = &list->files[list->count++];
    *file = (struct verify_file){.frame = frame,
                                 .is_known = true,
                                 .header_frame = frame,
                                 .width_px = 4,
                                 .height_px = 3,
                                 .picture_hash = "p",
                                 .sequence_hash = "one"};
    file->name = xasprintf("a.%04d.exr", frame);
    file->digits_start = 2;
    file->digit_count = 4;
    return file;
}

static struct verify_list make_list(size_t count, const int32_t frames[])
{
    struct verify_list list = {0};

    for (size_t i = 0; i < count; i++)
        add(&list, frames[i]);
    return list;
}

#define LIST(...) make_list(sizeof(int32_t[]){__VA_ARGS__} / sizeof(int32_t), (int32_t[]){__VA_ARGS__})

static struct verify_sequence judge(struct verify_list *list, const char *range_text)
{
    struct frame_range range = {0};
    struct verify_expected expected = {.range = range_text ? &range : NULL};
    struct verify_sequence sequence;

    if (range_text) assert_true(frame_range_parse(&range, range_text, NULL));
    verify_sequence_judge(&sequence, list, 0, list->count, &expected);
    frame_range_finish(&range);
    return sequence;
}

static void assert_missing(struct verify_list list, const char *range, const char *missing, int64_t count)
{
    struct verify_sequence sequence = judge(&list, range);

    assert_string_equal(sequence.missing, missing);
    assert_int_equal(sequence.missing_count, count);
    verify_sequence_finish(&sequence);
    verify_list_finish(&list);
}

static void gaps_are_named(void **state)
{
    assert_missing(LIST(0, 1, 2), NULL, "", 0);
    assert_missing(LIST(5), NULL, "", 0);
    assert_missing(LIST(1, 3, 4), NULL, "2", 1);
    assert_missing(LIST(0, 1, 4, 5, 9), NULL, "2-3,6-8", 5);
    assert_missing(LIST(0, 60, 240, 300), NULL, "120,180", 2); // in steps of 60
    assert_missing(LIST(0, 2, 12), NULL, "4-10x2", 4);
    assert_missing(LIST(0, 1, 2000000000), NULL, "2-1999999999", 1999999998);
}

static void expected_frames_are_those_of_the_range(void **state)
{
    assert_missing(LIST(3, 4), "0-6", "0-2,5-6", 5);
    assert_missing(LIST(0, 4, 5), "8-0x4", "8", 1);
    assert_missing(make_list(1, (int32_t[]){9}), "1-2", "1-2", 2);
    assert_missing(LIST(1, 1, 2), "1-3", "3", 1);
}

static void frames_there_are_named(void **state)
{
    struct verify_list list = LIST(0, 1, 2, 4, 7, 8, 9);
    struct verify_sequence sequence = judge(&list, NULL);

    assert_string_equal(sequence.frames, "0-2,4,7-9");
    assert_string_equal(sequence.pattern, "a.####.exr");
    assert_int_equal(sequence.worst, SIZE_MAX);
    verify_sequence_finish(&sequence);
    verify_list_finish(&list);
}

static void files_unlike_most_are_blamed(void **state)
{
    struct verify_list list = LIST(0, 1, 2, 3, 4);
    struct verify_sequence sequence;

    list.files[0].width_px = 3;
    strcpy(list.files[3].sequence_hash, "two");
    list.files[4].is_known = false; // it cannot be read: its size is not judged
    list.files[4].width_px = 0;
    list.files[2].header_frame = 7;
    sequence = judge(&list, NULL);
    assert_string_equal(list.files[0].wrong, "its size is 3 x 3, most files of the sequence have 4 x 3");
    assert_null(list.files[1].wrong);
    assert_string_equal(list.files[2].wrong, "its name says frame 2, its header 7");
    assert_string_equal(list.files[3].wrong,
                        "it is of another job, or of another version of it: two, most files of the sequence have one");
    assert_null(list.files[4].wrong);
    assert_int_equal(sequence.wrong_count, 3);
    verify_sequence_finish(&sequence);
    verify_list_finish(&list);
}

// Without the job's hash that of the picture is compared; in a tie the first file is right.
static void older_files_are_compared_by_their_pictures(void **state)
{
    struct verify_list list = LIST(0, 1);
    struct verify_sequence sequence;

    list.files[0].sequence_hash[0] = list.files[1].sequence_hash[0] = '\0';
    strcpy(list.files[1].picture_hash, "q");
    sequence = judge(&list, NULL);
    assert_null(list.files[0].wrong);
    assert_string_equal(list.files[1].wrong,
                        "it is of another job, or of another version of it: q, most files of the sequence have p");
    verify_sequence_finish(&sequence);
    verify_list_finish(&list);
}

static void what_is_left_out_most_is_found(void **state)
{
    struct verify_list list = LIST(0, 1, 2, 3);
    struct verify_sequence sequence = judge(&list, NULL);

    assert_int_equal(sequence.most_beyond, SIZE_MAX);
    verify_sequence_finish(&sequence);
    for (int i = 0; i < 4; i++)
        list.files[i].beyond = (struct job_beyond){.is_known = i < 3, .error = i == 1 ? 0.5 : i == 3 ? 1.0 : 0.0};
    sequence = judge(&list, NULL);
    assert_int_equal(sequence.most_beyond, 1);
    verify_sequence_finish(&sequence);
    verify_list_finish(&list);
}

static void worst_error_is_found(void **state)
{
    struct verify_list list = LIST(0, 1, 2, 3);
    struct verify_sequence sequence;

    for (int i = 0; i < 3; i++) {
        strcpy(list.files[i].accuracy.audit, "reference");
        list.files[i].accuracy.error = i == 1 ? 0.5 : 0.25;
    }
    list.files[3].accuracy.error = 1; // not measured
    sequence = judge(&list, NULL);
    assert_int_equal(sequence.worst, 1);
    verify_sequence_finish(&sequence);
    verify_list_finish(&list);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gaps_are_named),
        cmocka_unit_test(expected_frames_are_those_of_the_range),
        cmocka_unit_test(frames_there_are_named),
        cmocka_unit_test(files_unlike_most_are_blamed),
        cmocka_unit_test(older_files_are_compared_by_their_pictures),
        cmocka_unit_test(worst_error_is_found),
        cmocka_unit_test(what_is_left_out_most_is_found),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
