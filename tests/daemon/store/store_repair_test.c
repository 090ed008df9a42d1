// What a flipped bit on the disk does to the store, with and without a backup.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_repair.h"

#include "daemon/store/store_backup.h"
#include "daemon/store/store_reader.h"
#include "tests/daemon/store/store_fixture.h"

#include <fcntl.h>
#include <inttypes.h>
#include <sqlite3.h>
#include <sys/stat.h>

enum { JOB_COUNT = 6, FRAME_COUNT = 40 };

static struct store_op named_job_op(int64_t id)
{
    struct store_op op = job_op(id);

    free(op.job.name);
    op.job.name = xasprintf("name-of-%" PRId64, id);
    return op;
}

static void make_store(const struct folder *folder)
{
    struct store *store = open_store(folder);

    for (int64_t id = 1; id <= JOB_COUNT; id++)
        commit_one(store, named_job_op(id));
    for (int32_t i = 0; i < FRAME_COUNT; i++)
        commit_one(store, frame_op(1 + i % 2, i, FRAME_SUCCEEDED));
    store_close(store);
}

static void keep_backup(const struct folder *folder)
{
    char *path = xasprintf("%s/" STORE_BACKUP_NAME, folder->path);
    struct error error = {0};

    if (!store_backup_save(folder->path, path, &error)) fail_msg("%s", error.message);
    free(path);
}

static char *read_whole(const struct folder *folder, size_t *size_bytes)
{
    char *path = xasprintf("%s/queue.db", folder->path), *bytes;
    FILE *file = fopen(path, "rb");

    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size_bytes = (size_t)ftell(file);
    rewind(file);
    bytes = xmalloc(*size_bytes);
    assert_int_equal(fread(bytes, 1, *size_bytes, file), *size_bytes);
    fclose(file);
    free(path);
    return bytes;
}

static void write_whole(const struct folder *folder, const char *bytes, size_t size_bytes)
{
    char *path = xasprintf("%s/queue.db", folder->path);
    FILE *file = fopen(path, "wb");

    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size_bytes, file), size_bytes);
    fclose(file);
    free(path);
}

// Flips one bit of the first place where the file has the text.
static void flip_in(const struct folder *folder, const char *text)
{
    size_t size_bytes;
    char *bytes = read_whole(folder, &size_bytes);
    char *place = memmem(bytes, size_bytes, text, strlen(text));

    assert_non_null(place);
    place[strlen(text) - 1] ^= 4;
    write_whole(folder, bytes, size_bytes);
    free(bytes);
}

// All that a load gives, as text.
struct story {
    char *text;
    int damaged, jobs, frames;
};

static bool tell_job(void *user, const struct store_job *job, struct error *error)
{
    struct story *story = user;
    char *longer = xasprintf("%s%" PRId64 " %s %s %s %" PRId64 " %d %s|", story->text, job->id, job->name, job->owner,
                             job->root, job->owner_uid, job->priority, job->document ? job->document : "-");

    free(story->text);
    story->text = longer;
    story->jobs++;
    story->damaged += job->is_damaged || job->is_document_damaged;
    return true;
}

static bool tell_frame(void *user, const struct store_frame *frame, struct error *error)
{
    struct story *story = user;

    story->frames++;
    assert_true(frame->state == FRAME_SUCCEEDED && frame->size_bytes == 123456789012);
    return true;
}

// False when the store cannot be opened or loaded, with a sentence.
static bool read_story(const struct folder *folder, struct story *story)
{
    struct error error = {0};
    struct store *store = store_open(folder->path, NULL, &error);
    bool ok;

    *story = (struct story){.text = xstrdup("")};
    ok = store && store_load(store, tell_job, tell_frame, story, &error);
    store_close(store);
    assert_true(ok || error.message[0]);
    return ok;
}

static void assert_restored(const struct folder *folder, const char *text)
{
    struct story before, after;

    make_store(folder);
    keep_backup(folder);
    assert_true(read_story(folder, &before));
    flip_in(folder, text);
    assert_true(read_story(folder, &after));
    assert_string_equal(after.text, before.text);
    assert_int_equal(after.frames, before.frames);
    assert_int_equal(after.damaged, 0);
    free(before.text);
    free(after.text);
}

static void a_jobs_row_is_restored(void **state)
{
    assert_restored(*state, "name-of-4");
}

static void a_document_is_restored(void **state)
{
    assert_restored(*state, "{\"frames\": \"1-3\"}");
}

static void a_frames_row_is_restored(void **state)
{
    assert_restored(*state, "00112233445566778899aabbccddeeff");
}

static void without_a_backup_a_job_says_so_and_a_frame_is_looked_at_again(void **state)
{
    const struct folder *folder = *state;
    struct story story;

    make_store(folder);
    flip_in(folder, "name-of-4");
    flip_in(folder, "00112233445566778899aabbccddeeff");
    assert_true(read_story(folder, &story));
    assert_int_equal(story.jobs, JOB_COUNT);
    assert_int_equal(story.damaged, 1);
    assert_int_equal(story.frames, FRAME_COUNT - 1);
    free(story.text);
    assert_true(read_story(folder, &story)); // and says so until somebody acts
    assert_int_equal(story.damaged, 1);
    free(story.text);
}

// Whatever bit of the file is flipped, the store is as it was: by rows, or as a whole.
static void any_flipped_bit_is_restored(void **state)
{
    const struct folder *folder = *state;
    struct story before, after;
    size_t size_bytes;
    char *bytes;

    make_store(folder);
    assert_true(read_story(folder, &before));
    keep_backup(folder);
    bytes = read_whole(folder, &size_bytes);
    for (size_t at = 101, round = 0; at < size_bytes; at += 1009, round++) {
        bytes[at] ^= (char)(1 << round % 8);
        write_whole(folder, bytes, size_bytes);
        bytes[at] ^= (char)(1 << round % 8);
        if (!read_story(folder, &after) || strcmp(after.text, before.text) != 0 || after.frames != before.frames)
            fail_msg("bit %zu of byte %zu: %d jobs, %d frames: %s", round % 8, at, after.jobs, after.frames,
                     after.text);
        free(after.text);
    }
    free(before.text);
    free(bytes);
}

static void put_back(const struct folder *folder, const char *copy, bool knows_counts)
{
    struct error error = {0};
    bool has_counts;

    if (!store_backup_restore(folder->path, copy, &has_counts, &error)) fail_msg("%s", error.message);
    assert_true(has_counts == knows_counts);
}

static void ids_and_epochs_go_on_after_a_restore(void **state)
{
    const struct folder *folder = *state;
    char *copy = xasprintf("%s/copy.db", folder->root), *counts = xasprintf("%s/counts", folder->path);
    struct error error = {0};
    struct stat status;
    struct store *store;
    int64_t epoch;

    make_store(folder);
    assert_true(store_backup_save(folder->path, copy, &error));
    assert_int_equal(stat(copy, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600);
    store = open_store(folder);
    commit_one(store, job_op(JOB_COUNT + 1)); // after the backup
    epoch = store_epoch(store);
    assert_false(store_backup_restore(folder->path, copy, &(bool){0}, &error));
    assert_non_null(strstr(error.message, "another marchd"));
    store_close(store);

    put_back(folder, copy, true);
    store = open_store(folder);
    assert_int_equal(load(store).jobs, JOB_COUNT);
    assert_int_equal(store_next_job_id(store), JOB_COUNT + 2);
    assert_true(store_epoch(store) > epoch);
    store_close(store);

    assert_int_equal(unlink(counts), 0); // as in the folder of another machine
    put_back(folder, copy, false);
    store = open_store(folder);
    assert_true(store_next_job_id(store) > JOB_COUNT + 1000);
    store_close(store);
    free(copy);
    free(counts);
}

static void what_is_no_store_is_not_restored(void **state)
{
    const struct folder *folder = *state;
    char *copy = xasprintf("%s/copy.db", folder->root),
         *expected = xasprintf("%s is damaged, or no copy of a queue", copy);
    struct error error = {0};
    FILE *file = fopen(copy, "wb");

    make_store(folder);
    assert_non_null(file);
    for (int i = 0; i < 1000; i++)
        fputs("no store ", file);
    fclose(file);
    assert_false(store_backup_restore(folder->path, copy, &(bool){0}, &error));
    assert_string_equal(error.message, expected);
    store_close(open_store(folder));
    free(copy);
    free(expected);
}

static void a_damaged_copy_is_not_restored(void **state)
{
    const struct folder *folder = *state;
    char *target = xasprintf("%s/copy.db", folder->root);
    struct error error = {0};

    make_store(folder);
    flip_in(folder, "name-of-4");
    assert_false(store_backup_save(folder->path, target, &error));
    assert_non_null(strstr(error.message, "has 1 damaged rows"));
    assert_int_not_equal(access(target, F_OK), 0);
    free(target);
}

// What the disk changed since the look would otherwise replace the only good copy.
static void a_copy_of_rows_that_were_damaged_since_is_dropped(void **state)
{
    const struct folder *folder = *state;
    char *queue = xasprintf("%s/queue.db", folder->path), *backup = xasprintf("%s/" STORE_BACKUP_NAME, folder->path);
    struct error error = {0};
    struct stat before, after;
    sqlite3 *db = NULL;

    make_store(folder);
    keep_backup(folder);
    assert_int_equal(stat(backup, &before), 0);
    flip_in(folder, "name-of-4");
    assert_int_equal(sqlite3_open(queue, &db), SQLITE_OK);
    assert_false(store_backup_write(db, backup, 0, &error));
    assert_string_equal(error.message, "store: the new backup is dropped: it has 1 damaged rows");
    assert_int_equal(stat(backup, &after), 0);
    assert_true(before.st_ino == after.st_ino);
    assert_true(store_backup_write(db, backup, 1, &error)); // one that nothing could mend
    sqlite3_close(db);
    free(queue);
    free(backup);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_jobs_row_is_restored, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_document_is_restored, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_frames_row_is_restored, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(without_a_backup_a_job_says_so_and_a_frame_is_looked_at_again, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(ids_and_epochs_go_on_after_a_restore, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_is_no_store_is_not_restored, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_damaged_copy_is_not_restored, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_copy_of_rows_that_were_damaged_since_is_dropped, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(any_flipped_bit_is_restored, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
