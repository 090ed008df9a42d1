// SPDX-License-Identifier: Apache-2.0
#include "daemon/output/output_older.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/farm/job_table.h"

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

static int set_up(void **state)
{
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
    return 0;
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
    snprintf(record->hash, sizeof record->hash, "%s", hash);
    record->queued = queue_add_job(queue, &(struct queue_job_params){.id = id, .frames = &range, .priority = 50});
    for (int64_t i = 3; i < 6; i++)
        queue_restore_frame(record->queued, i, FRAME_SUCCEEDED, 1);
    return record;
}

static const int32_t there[] = {6, 5, 2, 3};
enum { THERE = sizeof there / sizeof there[0] };

static void frames_of_another_version_are_named(void **state)
{
    struct error error = {0};

    add(7, "old", 1);
    assert_true(output_older_is_likely(&table, &files, "new"));
    assert_false(output_older_check(&table, &files, "new", there, THERE, &error));
    assert_non_null(strstr(error.message, "output.path: c.05.exr and 1 more would be replaced, which job 7 (\"ash\")"));
    assert_non_null(strstr(error.message, "--set output.existing=overwrite"));
    assert_true(output_older_check(&table, &files, "new", there + 2, 2, &error)); // 4 to 6 are no longer there
    assert_true(output_older_check(&table, &files, "new", NULL, 0, &error));
}

static void frames_of_this_version_are_welcome(void **state)
{
    add(7, "same", 1);
    assert_false(output_older_is_likely(&table, &files, "same"));
    assert_true(output_older_check(&table, &files, "same", there, THERE, NULL));
}

static void the_job_that_ended_last_made_the_file(void **state)
{
    add(7, "old", 5);
    add(8, "same", 9);
    assert_true(output_older_is_likely(&table, &files, "same"));
    assert_true(output_older_check(&table, &files, "same", there, THERE, NULL));
    add(9, "other", 7);
    assert_true(output_older_check(&table, &files, "same", there, THERE, NULL));
    assert_false(output_older_check(&table, &files, "old", there, THERE, NULL));
}

static void drafts_are_replaced(void **state)
{
    add(7, "old", 1)->is_draft = true;
    assert_false(output_older_is_likely(&table, &files, "new"));
    assert_true(output_older_check(&table, &files, "new", there, THERE, NULL));
}

static void files_of_the_frames_are_listed(void **state)
{
    static const char *const names[] = {"c.03.exr", "c.12.exr", "c.7.exr", "d.04.exr"};
    char folder[] = "/tmp/output_older_test.XXXXXX", name[64];
    int32_t *found;
    size_t count;
    int fd;

    assert_non_null(mkdtemp(folder));
    for (size_t i = 0; i < 4; i++) {
        snprintf(name, sizeof name, "%s/%s", folder, names[i]);
        fclose(fopen(name, "w"));
    }
    fd = open(folder, O_RDONLY | O_DIRECTORY);
    found = output_older_list(&files, fd, &count);
    assert_int_equal(count, 1);
    assert_int_equal(found[0], 3);
    free(found);
    close(fd);
    for (size_t i = 0; i < 4; i++) {
        snprintf(name, sizeof name, "%s/%s", folder, names[i]);
        unlink(name);
    }
    rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(frames_of_another_version_are_named, set_up, tear_down),
        cmocka_unit_test_setup_teardown(frames_of_this_version_are_welcome, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_job_that_ended_last_made_the_file, set_up, tear_down),
        cmocka_unit_test_setup_teardown(drafts_are_replaced, set_up, tear_down),
        cmocka_unit_test_setup_teardown(files_of_the_frames_are_listed, set_up, tear_down),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
