// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/restore.h"

#include "core/base/file.h"
#include "core/base/hash.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"
#include "daemon/store/store_backup.h"
#include "daemon/store/store_reader.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sum.h"
#include "tests/daemon/store/store_fixture.h"
#include "tests/support/folders.h"

#include <fcntl.h>
#include <inttypes.h>
#include <sqlite3.h>
#include <sys/stat.h>

// A farm over a store of an older version, which knows no roots: job 1 writes frames 1 to 3 below FOLDER/out. Frame 1
// is published, and frame 2 was being published when the daemon ended.
struct stage {
    const struct folder *folder;
    char *root;
    struct store *store;
    struct options options;
    uv_loop_t loop;
    struct farm farm;
};

static char *at(const struct stage *stage, const char *name)
{
    static char path[256];

    snprintf(path, sizeof path, "%s/%s", stage->folder->root, name);
    return path;
}

static void write_file(const char *path)
{
    int fd = open(path, O_WRONLY | O_CREAT, 0644);

    assert_true(fd >= 0);
    assert_int_equal(write(fd, "text", 4), 4);
    close(fd);
}

static void add_job(struct stage *stage)
{
    struct store_op job = job_op(1), done = frame_op(1, 0, FRAME_SUCCEEDED), intent = frame_op(1, 1, FRAME_RUNNING);
    struct stat status;

    free(job.job.document);
    free(job.job.root);
    job.job.root = xstrdup(stage->root);
    job.job.document =
        xstrdup("{\"version\":1,\"name\":\"j\",\"frames\":\"1-3\",\"fps\":24,\"resolution\":[16,9],"
                "\"camera\":{\"position\":[0,0,4],\"target\":[0,0,0],\"fov\":30},\"scene\":{\"media\":[{"
                "\"density\":{\"kind\":\"noise\",\"frequency\":1,\"bounds\":{\"kind\":\"sphere\","
                "\"center\":[0,0,0],\"radius\":1}},\"sigma_a\":1}]},\"quality\":{\"method\":\"midpoint\","
                "\"step\":0.1},\"output\":{\"path\":\"a/f.####.exr\"}}");
    if (stat(at(stage, "out/a/f.0002.exr.1.7.2.part"), &status) == 0) intent.frame.inode = status.st_ino;
    intent.frame.size_bytes = 4;
    hash_bytes("text", 4, intent.frame.hash);
    commit_one(stage->store, job);
    commit_one(stage->store, done);
    commit_one(stage->store, intent);
}

static struct stage *stage_begin(void **state)
{
    struct stage *stage = xcalloc(1, sizeof *stage);

    stage->folder = *state;
    stage->root = xstrdup(at(stage, "out"));
    return stage;
}

static void open_farm(struct stage *stage)
{
    assert_int_equal(uv_loop_init(&stage->loop), 0);
    stage->options = (struct options){
        .state_folder = xstrdup(stage->folder->path), .half_life_ms = 3600 * 1000, .admin_group = xstrdup("nobody")};
    path_list_add(&stage->options.output_roots, xstrdup(stage->root));
    stage->farm.loop = &stage->loop;
    stage->farm.options = &stage->options;
    stage->farm.queue = queue_create(3);
    stage->farm.reader = store_reader_open(stage->folder->path, NULL);
}

static struct stage *stage_create(void **state, bool has_root)
{
    struct stage *stage = stage_begin(state);

    if (has_root) {
        assert_int_equal(mkdir(at(stage, "out"), 0755), 0);
        assert_int_equal(mkdir(at(stage, "out/a"), 0755), 0);
        write_file(at(stage, "out/a/f.0002.exr.1.7.2.part"));
    }
    stage->store = open_store(stage->folder);
    add_job(stage);
    open_farm(stage);
    return stage;
}

static void stage_destroy(struct stage *stage)
{
    const char *const names[] = {"out/a/f.0002.exr", "out/a/f.0002.exr.1.7.2.part", "out/a", "out/.marchd-root", "out",
                                 "state/reserve"};

    store_reader_close(stage->farm.reader);
    store_close(stage->store);
    queue_destroy(stage->farm.queue);
    job_table_finish(&stage->farm.jobs);
    root_table_finish(&stage->farm.roots);
    quota_finish(&stage->farm.quota);
    options_finish(&stage->options);
    uv_loop_close(&stage->loop);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        remove(at(stage, names[i]));
    free(stage->root);
    free(stage);
}

static void restore(struct stage *stage)
{
    struct error error = {0};

    if (!restore_farm(&stage->farm, stage->store, &error)) fail_msg("%s", error.message);
}

static void root_of_an_older_version_is_marked_and_its_part_file_published(void **state)
{
    struct stage *stage = stage_create(state, true);
    const struct job_record *record;
    char farm[ROOT_MARKER_ID_SIZE];

    restore(stage);
    record = stage->farm.jobs.records[0];
    assert_true(record->output_root->is_there && root_marker_is_id(record->output_root->id));
    assert_true(root_marker_find_farm(stage->root, stage->folder->path, farm));
    assert_string_equal(farm, stage->farm.id);
    assert_int_equal(record->queued->states.counts[FRAME_SUCCEEDED], 2);
    assert_int_equal(access(at(stage, "out/a/f.0002.exr"), F_OK), 0);
    assert_int_not_equal(queue_job_state(record->queued), JOB_PAUSED);
    stage_destroy(stage);
}

static void root_with_jobs_is_not_made_and_they_wait(void **state)
{
    struct stage *stage = stage_create(state, false);
    const struct job_record *record;

    restore(stage);
    record = stage->farm.jobs.records[0];
    assert_false(record->output_root->is_there);
    assert_int_equal(access(stage->root, F_OK), -1);
    assert_int_equal(queue_job_state(record->queued), JOB_PAUSED);
    assert_int_equal(record->queued->states.counts[FRAME_QUEUED], 2);
    // Whether frame 2 is published says the root when it is back, also after another start.
    assert_int_equal(record->intent_count, 1);
    assert_int_equal(record->intents[0].index, 1);
    assert_int_equal(record->intents[0].attempts, 2);
    assert_int_equal(load(stage->store).frame.state, FRAME_RUNNING);
    stage_destroy(stage);
}

// Puts a backup of the stopped store in its place.
static void pass_through_backup(const struct stage *stage)
{
    char *copy = xasprintf("%s/copy.db", stage->folder->root), *other = xasprintf("%s/other", stage->folder->root);
    struct error error = {0};
    bool has_counts = true;

    if (!store_backup_save(stage->folder->path, copy, &error)) fail_msg("%s", error.message);
    assert_int_equal(mkdir(other, 0700), 0);
    if (!store_backup_restore(other, copy, &has_counts, &error)) fail_msg("%s", error.message);
    assert_false(has_counts);
    free(copy);
    copy = xasprintf("%s/queue.db", other);
    assert_int_equal(rename(copy, at(stage, "state/queue.db")), 0);
    free(copy);
    for (const char *const *name = (const char *const[]){"lock", "counts", NULL}; *name; name++) {
        copy = xasprintf("%s/%s", other, *name);
        assert_int_equal(unlink(copy), 0);
        free(copy);
    }
    assert_int_equal(rmdir(other), 0);
    free(other);
}

// A store that a daemon of that version wrote (stores/version_N.sql). Its jobs write below /films, which is not there.
static struct stage *stage_create_of_version(void **state, int version)
{
    struct stage *stage = stage_begin(state);
    struct error error = {0};
    sqlite3 *db = NULL;
    char path[256], *text;

    snprintf(path, sizeof path, PROJECT_ROOT "/tests/daemon/service/stores/version_%d.sql", version);
    if (!file_read_text(path, 1 << 20, &text, NULL, &error)) fail_msg("%s", error.message);
    assert_int_equal(mkdir(stage->folder->path, 0700), 0);
    assert_int_equal(sqlite3_open(at(stage, "state/queue.db"), &db), SQLITE_OK);
    if (sqlite3_exec(db, text, NULL, NULL, NULL) != SQLITE_OK) fail_msg("%s: %s", path, sqlite3_errmsg(db));
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    free(text);
    pass_through_backup(stage);
    stage->store = open_store(stage->folder);
    open_farm(stage);
    return stage;
}

static char *format_jobs(const struct job_table *jobs)
{
    char *text = xstrdup("");

    for (size_t i = 0; i < jobs->count; i++) {
        const struct job_record *job = jobs->records[i];
        const int64_t *counts = job->queued->states.counts;
        char *longer = xasprintf("%s%" PRId64 " %s %s %d: %s, %" PRId64 " queued, %" PRId64 " there, %" PRId64
                                 " failed, %" PRId64 " canceled, %" PRId64 " bytes; %s; %.8s\n",
                                 text, job->id, job->name, job->owner, job->queued->priority,
                                 job_state_name(queue_job_state(job->queued)), counts[FRAME_QUEUED],
                                 counts[FRAME_SUCCEEDED], counts[FRAME_FAILED], counts[FRAME_CANCELED], job->disk_bytes,
                                 job->reason ? job->reason : "-", job->facts.hash);

        free(text);
        text = longer;
    }
    return text;
}

static bool on_attempt(void *user, const struct store_attempt *attempt, struct error *error)
{
    int *count = user;

    (void)error;
    (*count)++;
    assert_string_equal(attempt->log, "shader: x.glsl:1: error: `nothing' undeclared");
    return true;
}

static int64_t count_damaged(struct stage *stage)
{
    sqlite3 *db = NULL;
    int64_t count = -1;

    assert_int_equal(sqlite3_open(at(stage, "state/queue.db"), &db), SQLITE_OK);
    assert_true(store_sum_register(db, NULL) && store_sum_count_damaged(db, STORE_SCHEMA_VERSION, &count, NULL));
    sqlite3_close(db);
    return count;
}

// All hold the same jobs. The hash of the first is also in the key of its plan, which its own daemon wrote.
static void check_version(void **state, int version, const char *bytes, const char *half_bytes)
{
    struct stage *stage = stage_create_of_version(state, version);
    char *jobs,
        *expected =
            xasprintf("1 castle root 50: succeeded, 0 queued, 3 there, 0 failed, 0 canceled, %s bytes; -; 9e405e8f\n"
                      "2 broken root 50: failed, 0 queued, 0 there, 2 failed, 0 canceled, 0 bytes; "
                      "shader: x.glsl:1: error: `nothing' undeclared; abaa6e30\n"
                      "3 Höhle root 50: canceled, 0 queued, 0 there, 0 failed, 5 canceled, 0 bytes; "
                      "canceled by root; fca412e0\n"
                      "4 held root 70: paused, 4 queued, 0 there, 0 failed, 0 canceled, 0 bytes; "
                      "paused by root; 44ba8a48\n"
                      "5 half root 50: paused, 18 queued, 3 there, 0 failed, 0 canceled, %s bytes; -; b8382c42\n",
                      bytes, half_bytes);
    int attempts = 0;

    restore(stage);
    jobs = format_jobs(&stage->farm.jobs);
    assert_string_equal(jobs, expected);
    assert_true(store_read_attempts(stage->farm.reader, 2, -1, 9, on_attempt, &attempts, NULL));
    assert_int_equal(attempts, 1);
    assert_int_equal(stage->farm.next_job_id, 7); // job 6 was deleted
    assert_int_equal(stage->farm.next_plan_number, 2);
    assert_int_equal(count_damaged(stage), 0);
    free(jobs);
    free(expected);
    stage_destroy(stage);
}

static void store_of_version_5_is_restored(void **state)
{
    check_version(state, 5, "8577", "380634");
}

static void store_of_version_8_is_restored(void **state)
{
    check_version(state, 8, "8739", "380790");
}

// The sums of its rows are those of today.
static void store_of_version_9_is_restored(void **state)
{
    check_version(state, 9, "8904", "380920");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(root_of_an_older_version_is_marked_and_its_part_file_published, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(root_with_jobs_is_not_made_and_they_wait, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(store_of_version_5_is_restored, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(store_of_version_8_is_restored, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(store_of_version_9_is_restored, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
