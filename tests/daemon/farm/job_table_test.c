// SPDX-License-Identifier: Apache-2.0
#include "core/base/alloc.h"
#include "daemon/farm/job_table.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

struct fixture {
    struct queue *queue;
    struct job_table table;
};

static int create(void **state)
{
    struct fixture *fixture = xcalloc(1, sizeof *fixture);

    fixture->queue = queue_create(3);
    *state = fixture;
    return 0;
}

static int destroy(void **state)
{
    struct fixture *fixture = *state;

    job_table_finish(&fixture->table);
    queue_destroy(fixture->queue);
    free(fixture);
    return 0;
}

static struct job_record *add(struct fixture *fixture, int64_t id, const char *pattern, const char *range)
{
    struct job_record *record;
    struct frame_range frames = {0};
    struct output_path path;

    assert_true(output_path_parse(&path, pattern, NULL));
    record = job_table_add(&fixture->table, id, xstrdup("/out"), &path);
    assert_true(frame_range_parse(&frames, range, NULL));
    record->queued =
        queue_add_job(fixture->queue, &(struct queue_job_params){.id = id, .frames = &frames, .priority = 50});
    return record;
}

static int64_t find(const struct fixture *fixture, const char *root, const char *pattern, const char *range,
                    int32_t *frame)
{
    struct output_path path = {0};
    struct frame_range frames = {0};
    const struct job_record *found;

    assert_true(output_path_parse(&path, pattern, NULL));
    assert_true(frame_range_parse(&frames, range, NULL));
    found = job_table_find_collision(&fixture->table, &(struct job_files){root, &path, &frames, NULL}, frame);
    output_path_finish(&path);
    frame_range_finish(&frames);
    return found ? found->id : 0;
}

static void jobs_are_found_by_id(void **state)
{
    struct fixture *fixture = *state;

    for (int64_t id = 1; id <= 20; id += 3)
        add(fixture, id, "a.#.exr", "1");
    for (int64_t id = 0; id <= 22; id++)
        assert_true((job_table_find(&fixture->table, id) != NULL) == (id % 3 == 1 && id <= 20));
}

static void ranges_that_meet_in_one_file_collide(void **state)
{
    struct fixture *fixture = *state;
    int32_t frame = -1;

    add(fixture, 1, "cloud/c.####.exr", "1-100");
    assert_int_equal(find(fixture, "/out", "cloud/c.####.exr", "100-200", &frame), 1);
    assert_int_equal(frame, 100);
    assert_int_equal(find(fixture, "/out", "cloud/c.####.exr", "101-200", &frame), 0);
    assert_int_equal(find(fixture, "/out", "cloud/d.####.exr", "1-100", &frame), 0);
    assert_int_equal(find(fixture, "/out", "c.####.exr", "1-100", &frame), 0);
}

static void a_wider_number_of_the_same_digits_is_the_same_file(void **state)
{
    struct fixture *fixture = *state;
    int32_t frame = -1;

    add(fixture, 1, "c.##.exr", "90-110");
    assert_int_equal(find(fixture, "/out", "c.###.exr", "1-99", &frame), 0);
    assert_int_equal(find(fixture, "/out", "c.###.exr", "1-99,111-200", &frame), 0);
    assert_int_equal(find(fixture, "/out", "c.###.exr", "1-105", &frame), 1);
    assert_int_equal(frame, 100);
}

static void another_root_is_compared_in_full(void **state)
{
    struct fixture *fixture = *state;
    int32_t frame = -1;

    add(fixture, 1, "show/c.#.exr", "1-9");
    assert_int_equal(find(fixture, "/out/show", "c.#.exr", "9", &frame), 1);
    assert_int_equal(find(fixture, "/out/other", "c.#.exr", "9", &frame), 0);
}

static void a_job_that_is_over_does_not_collide(void **state)
{
    struct fixture *fixture = *state;
    struct job_record *record = add(fixture, 1, "c.#.exr", "1-9");
    struct frame_range nine;
    const struct job_files others = {"/out", &record->path, &nine, NULL};
    int32_t frame = -1;

    assert_true(frame_range_parse(&nine, "9", NULL));
    assert_null(job_table_find_ending(&fixture->table, &others, &frame)); // it is live
    queue_cancel(fixture->queue, record->queued);
    record->frames_in_flight = 1;
    assert_int_equal(find(fixture, "/out", "c.#.exr", "9", &frame), 0);
    assert_ptr_equal(job_table_find_ending(&fixture->table, &others, &frame), record);
    assert_int_equal(frame, 9);
    record->frames_in_flight = 0;
    assert_null(job_table_find_ending(&fixture->table, &others, &frame));
    frame_range_finish(&nine);
}

static void a_job_that_is_being_deleted_collides(void **state)
{
    struct fixture *fixture = *state;
    struct job_record *record = add(fixture, 1, "c.#.exr", "1-9");
    int32_t frame = -1;

    queue_cancel(fixture->queue, record->queued);
    record->is_deleting = true;
    assert_int_equal(find(fixture, "/out", "c.#.exr", "9", &frame), 1);
}

// The sanitizer reports a record that is read after it was freed.
static void a_removed_record_lives_while_it_is_held(void **state)
{
    struct fixture *fixture = *state;
    struct job_record *first = add(fixture, 1, "a.#.exr", "1"), *second = add(fixture, 2, "b.#.exr", "1");
    struct job_record *third = add(fixture, 3, "c.#.exr", "1");

    job_record_hold(second);
    job_record_hold(second);
    job_table_remove(&fixture->table, second);
    assert_null(job_table_find(&fixture->table, 2));
    assert_ptr_equal(job_table_find(&fixture->table, 1), first);
    assert_ptr_equal(job_table_find(&fixture->table, 3), third);
    job_record_release(second);
    assert_int_equal(second->id, 2);
    job_record_release(second);
    job_table_remove(&fixture->table, third);
    assert_int_equal(fixture->table.count, 1);
    job_record_hold(first);
    job_record_release(first);
    assert_ptr_equal(job_table_find(&fixture->table, 1), first);
}

static struct job_record *find_owned(struct fixture *fixture, const char *pattern, int64_t owner_uid, int32_t *frame)
{
    struct output_path path;
    struct frame_range frames;
    struct job_record *record;

    assert_true(output_path_parse(&path, pattern, NULL));
    assert_true(frame_range_parse(&frames, "5-12", NULL));
    record = job_table_find_owned_files(&fixture->table, &(struct job_files){"/out", &path, &frames, NULL}, owner_uid,
                                        frame);
    output_path_finish(&path);
    frame_range_finish(&frames);
    return record;
}

static void published_files_belong_to_the_owner_of_their_job(void **state)
{
    struct fixture *fixture = *state;
    struct job_record *record = add(fixture, 1, "c.#.exr", "1-9");
    int32_t frame = -1;

    record->owner_uid = 1000;
    queue_cancel(fixture->queue, record->queued);
    assert_null(find_owned(fixture, "c.#.exr", 1001, &frame)); // this job published none
    record->queued->states.counts[FRAME_SUCCEEDED] = 1;
    assert_ptr_equal(find_owned(fixture, "c.#.exr", 1001, &frame), record);
    assert_int_equal(frame, 5);
    assert_null(find_owned(fixture, "c.#.exr", 1000, &frame));
    assert_null(find_owned(fixture, "d.#.exr", 1001, &frame));
    record->queued->states.counts[FRAME_SUCCEEDED] = 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(jobs_are_found_by_id, create, destroy),
        cmocka_unit_test_setup_teardown(ranges_that_meet_in_one_file_collide, create, destroy),
        cmocka_unit_test_setup_teardown(a_wider_number_of_the_same_digits_is_the_same_file, create, destroy),
        cmocka_unit_test_setup_teardown(another_root_is_compared_in_full, create, destroy),
        cmocka_unit_test_setup_teardown(a_job_that_is_over_does_not_collide, create, destroy),
        cmocka_unit_test_setup_teardown(a_job_that_is_being_deleted_collides, create, destroy),
        cmocka_unit_test_setup_teardown(a_removed_record_lives_while_it_is_held, create, destroy),
        cmocka_unit_test_setup_teardown(published_files_belong_to_the_owner_of_their_job, create, destroy),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
