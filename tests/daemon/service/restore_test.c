// SPDX-License-Identifier: Apache-2.0
#include "daemon/service/restore.h"

#include "core/base/hash.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"
#include "daemon/store/store_reader.h"
#include "tests/daemon/store/store_fixture.h"

#include <fcntl.h>
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

static struct stage *stage_create(void **state, bool has_root)
{
    struct stage *stage = xcalloc(1, sizeof *stage);

    stage->folder = *state;
    stage->root = xstrdup(at(stage, "out"));
    if (has_root) {
        assert_int_equal(mkdir(at(stage, "out"), 0755), 0);
        assert_int_equal(mkdir(at(stage, "out/a"), 0755), 0);
        write_file(at(stage, "out/a/f.0002.exr.1.7.2.part"));
    }
    stage->store = open_store(stage->folder);
    add_job(stage);
    assert_int_equal(uv_loop_init(&stage->loop), 0);
    stage->options = (struct options){
        .state_folder = xstrdup(stage->folder->path), .half_life_ms = 3600 * 1000, .admin_group = xstrdup("nobody")};
    path_list_add(&stage->options.output_roots, xstrdup(stage->root));
    stage->farm.loop = &stage->loop;
    stage->farm.options = &stage->options;
    stage->farm.queue = queue_create(3);
    stage->farm.reader = store_reader_open(stage->folder->path, NULL);
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
    assert_int_equal(record->queued->counts[FRAME_SUCCEEDED], 2);
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
    assert_int_equal(record->queued->counts[FRAME_QUEUED], 2); // what was being published is rendered again
    stage_destroy(stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(root_of_an_older_version_is_marked_and_its_part_file_published, make_folder,
                                        remove_folder),
        cmocka_unit_test_setup_teardown(root_with_jobs_is_not_made_and_they_wait, make_folder, remove_folder),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
