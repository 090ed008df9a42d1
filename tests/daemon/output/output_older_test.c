// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/output_older.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/farm/job_table.h"
#include "tests/support/picture_header.h"
#include "tests/support/temp_folder.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static struct queue *queue;
static struct job_table table;
static struct output_path path;
static struct frame_range frames;
static struct job_files files;

static int folder; // a temporary one

static int set_up(void **state)
{
    if (temp_folder_create(state) != 0) return -1;
    folder = open(*state, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    queue = queue_create(3);
    table = (struct job_table){0};
    assert_true(output_path_parse(&path, "a/c.##.exr", NULL));
    assert_true(frame_range_parse(&frames, "1-9", NULL));
    files = (struct job_files){"/out", &path, &frames, NULL};
    return 0;
}

static int tear_down(void **state)
{
    job_table_finish(&table);
    queue_destroy(queue);
    output_path_finish(&path);
    frame_range_finish(&frames);
    close(folder);
    return temp_folder_destroy(state);
}

// A job of frames 1 to 20 in the folder, of which 4 to 6 are published.
static struct job_record *add(int64_t id, const char *hash, int64_t finished_ms)
{
    struct frame_range range = {0};
    struct output_path own;
    struct job_record *record;

    assert_true(output_path_parse(&own, "a/c.##.exr", NULL));
    assert_true(frame_range_parse(&range, "1-20", NULL));
    record = job_table_add(&table, id, xstrdup("/out"), &own);
    record->name = xstrdup("ash");
    record->finished_ms = finished_ms;
    snprintf(record->facts.hash, sizeof record->facts.hash, "%s", hash);
    record->queued = queue_add_job(queue, &(struct queue_job_params){.id = id, .frames = &range, .priority = 50});
    for (int64_t i = 3; i < 6; i++)
        queue_restore_frame(record->queued, i, FRAME_SUCCEEDED, 1);
    return record;
}

static const int32_t there[] = {6, 5, 2, 3};
enum { THERE = sizeof there / sizeof there[0] };

// Whether a new job may write over those files.
static bool check(const char *hash, const int32_t *found, size_t count, struct error *error)
{
    struct output_older older = {.files = &files, .hash = hash, .count = count};
    bool ok;

    older.frames = xcalloc(count + 1, sizeof older.frames[0]);
    for (size_t i = 0; i < count; i++)
        older.frames[i] = found[i];
    while (output_older_step(&older, &table))
        continue;
    ok = output_older_check(&older, error);
    output_older_finish(&older);
    return ok;
}

static void frames_of_another_version_are_named(void **state)
{
    struct error error = {0};

    add(7, "old", 1);
    assert_true(output_older_is_likely(&table, &files, "new"));
    assert_false(check("new", there, THERE, &error));
    assert_non_null(strstr(error.message, "output.path: c.05.exr and 1 more would be replaced, which job 7 (\"ash\")"));
    assert_non_null(strstr(error.message, "--set output.existing=overwrite"));
    assert_true(check("new", there + 2, 2, &error)); // 4 to 6 are no longer there
    assert_true(check("new", NULL, 0, &error));
}

static void frames_of_this_version_are_welcome(void **state)
{
    add(7, "same", 1);
    assert_false(output_older_is_likely(&table, &files, "same"));
    assert_true(check("same", there, THERE, NULL));
}

static void the_job_that_ended_last_made_the_file(void **state)
{
    add(7, "old", 5);
    add(8, "same", 9);
    assert_true(output_older_is_likely(&table, &files, "same"));
    assert_true(check("same", there, THERE, NULL));
    add(9, "other", 7);
    assert_true(check("same", there, THERE, NULL));
    assert_false(check("old", there, THERE, NULL));
}

static void drafts_are_replaced(void **state)
{
    add(7, "old", 1)->facts.is_draft = true;
    assert_false(output_older_is_likely(&table, &files, "new"));
    assert_true(check("new", there, THERE, NULL));
}

// Their jobs may be deleted between the steps.
static void many_files_are_looked_at_in_steps(void **state)
{
    struct output_older older = {.files = &files, .hash = "new", .count = 9999};
    struct job_record *record = add(7, "old", 1);
    struct error error = {0};

    older.frames = xcalloc(older.count, sizeof older.frames[0]);
    for (size_t i = 0; i < older.count; i++)
        older.frames[i] = 4;
    assert_true(output_older_step(&older, &table));
    assert_true(older.next > 0 && older.next < older.count / 2);
    queue_remove_job(queue, record->queued);
    record->queued = NULL;
    job_table_remove(&table, record);
    while (output_older_step(&older, &table))
        continue;
    assert_false(output_older_check(&older, &error));
    assert_non_null(strstr(error.message, "which job 7 (\"ash\") published"));
    output_older_finish(&older);
}

static void make_picture(int32_t frame, const char *hash, bool is_draft)
{
    uint8_t bytes[PICTURE_HEADER_SIZE];
    size_t size = picture_header_write(bytes, hash, is_draft);
    char name[OUTPUT_NAME_SIZE];
    int fd;

    output_path_format_name(files.path, frame, name);
    fd = openat(folder, name, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    assert_int_equal(write(fd, bytes, size), size);
    close(fd);
}

static void files_of_the_frames_are_listed(void **state)
{
    static const char *const names[] = {"c.03.exr", "c.12.exr", "c.7.exr", "d.04.exr"};
    struct output_older older = {.files = &files, .hash = "new"};

    for (size_t i = 0; i < 4; i++)
        close(openat(folder, names[i], O_WRONLY | O_CREAT, 0600));
    output_older_list(&older, folder);
    assert_int_equal(older.count, 1);
    assert_int_equal(older.frames[0], 3);
    output_older_finish(&older);
}

static void many_frames_are_found_in_the_list_of_their_folder(void **state)
{
    struct frame_range many = {0};
    struct job_files all = files;

    assert_true(frame_range_parse(&many, "1-900x2", NULL));
    all.frames = &many;
    make_picture(8, NULL, false);
    make_picture(601, NULL, false);
    for (int pass = 0; pass < 2; pass++) { // from the list's beginning each time
        struct output_older older = {.files = &all, .hash = "new"};

        output_older_list(&older, folder);
        assert_int_equal(older.count, 1);
        assert_int_equal(older.frames[0], 601);
        output_older_finish(&older);
    }
    frame_range_finish(&many);
}

static const char same[] = "00112233445566778899aabbccddeeff", other[] = "ffeeddccbbaa99887766554433221100";

// Their job was deleted, or there was none.
static void pictures_that_no_job_has_are_known_by_their_headers(void **state)
{
    struct error error = {0};

    make_picture(3, same, false);
    make_picture(4, other, true);
    make_picture(5, NULL, false);
    for (int pass = 0; pass < 2; pass++) {
        struct output_older older;

        output_older_begin(&older, &table, &files, same);
        output_older_list(&older, folder);
        assert_false(output_older_step(&older, &table));
        assert_int_equal(older.seen, pass == 0 ? 0 : 2);
        assert_int_equal(output_older_check(&older, &error), pass == 0);
        output_older_finish(&older);
        make_picture(8, other, false);
        make_picture(7, other, false);
    }
    assert_non_null(strstr(error.message, "output.path: c.07.exr and others would be replaced, which march render or"));
    assert_non_null(strstr(error.message, "--set output.existing=overwrite"));
}

static void few_of_many_pictures_are_looked_into(void **state)
{
    struct frame_range many = {0};
    struct job_files all = files;
    struct output_older older = {.files = &all, .hash = same};

    assert_true(frame_range_parse(&many, "1-640", NULL));
    all.frames = &many;
    for (int32_t frame = 1; frame <= 640; frame++)
        make_picture(frame, other, false);
    output_older_list(&older, folder);
    assert_int_equal(older.count, 640);
    assert_int_equal(older.seen, 64);
    output_older_finish(&older);
    frame_range_finish(&many);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(frames_of_another_version_are_named, set_up, tear_down),
        cmocka_unit_test_setup_teardown(frames_of_this_version_are_welcome, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_job_that_ended_last_made_the_file, set_up, tear_down),
        cmocka_unit_test_setup_teardown(drafts_are_replaced, set_up, tear_down),
        cmocka_unit_test_setup_teardown(many_files_are_looked_at_in_steps, set_up, tear_down),
        cmocka_unit_test_setup_teardown(files_of_the_frames_are_listed, set_up, tear_down),
        cmocka_unit_test_setup_teardown(many_frames_are_found_in_the_list_of_their_folder, set_up, tear_down),
        cmocka_unit_test_setup_teardown(pictures_that_no_job_has_are_known_by_their_headers, set_up, tear_down),
        cmocka_unit_test_setup_teardown(few_of_many_pictures_are_looked_into, set_up, tear_down),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
