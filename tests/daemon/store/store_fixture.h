// A store in a temporary folder for one test, and rows for it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/store.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

struct folder {
    char root[64];
    char path[80]; // does not exist yet
};

static inline int make_folder(void **state)
{
    struct folder *folder = xcalloc(1, sizeof *folder);

    snprintf(folder->root, sizeof folder->root, "/tmp/marchd_store_XXXXXX");
    if (!mkdtemp(folder->root)) return -1;
    snprintf(folder->path, sizeof folder->path, "%s/state", folder->root);
    *state = folder;
    return 0;
}

static inline int remove_folder(void **state)
{
    static const char *const names[] = {"state/queue.db",
                                        "state/queue.db-wal",
                                        "state/queue.db-shm",
                                        "state/lock",
                                        "state/reserve",
                                        "state/counts",
                                        "state/backup.db",
                                        "state/backup.db.part",
                                        "state/queue.db.replaced",
                                        "state/queue.db.replaced-wal",
                                        "copy.db",
                                        "state"};
    struct folder *folder = *state;
    char path[128];

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        snprintf(path, sizeof path, "%s/%s", folder->root, names[i]);
        remove(path);
    }
    rmdir(folder->root);
    free(folder);
    return 0;
}

static inline struct store *open_store(const struct folder *folder)
{
    struct error error = {0};
    struct store *store = store_open(folder->path, NULL, &error);

    if (!store) fail_msg("%s", error.message);
    return store;
}

static inline struct store_op job_op(int64_t id)
{
    return (struct store_op){.kind = STORE_ADD_JOB,
                             .job = {.id = id,
                                     .document = xstrdup("{\"frames\": \"1-3\"}"),
                                     .name = xstrdup("ash"),
                                     .owner = xstrdup("ada"),
                                     .owner_uid = 1000,
                                     .priority = 50,
                                     .submitted_ms = 1700000000123,
                                     .root = xstrdup("/films")}};
}

static inline struct store_op frame_op(int64_t job, int32_t index, enum frame_state frame_state)
{
    return (struct store_op){.kind = STORE_SET_FRAME,
                             .frame = {.job = job,
                                       .index = index,
                                       .state = (int)frame_state,
                                       .attempts = 2,
                                       .epoch = 7,
                                       .inode = UINT64_MAX - 5,
                                       .size_bytes = 123456789012,
                                       .hash = "00112233445566778899aabbccddeeff",
                                       .render_s = 1.5,
                                       .encode_s = 0.25,
                                       .accuracy = {.audit = "reference",
                                                    .error = 0.0078125,
                                                    .error95 = 0.015625,
                                                    .audit_rays = 64,
                                                    .method = "cached",
                                                    .plan = 12,
                                                    .has_cut_share = true,
                                                    .cut_share = 0.125,
                                                    .traced = 0.0625}}};
}

static inline void assert_accuracy(const struct frame_accuracy *accuracy)
{
    assert_string_equal(accuracy->audit, "reference");
    assert_true(accuracy->error == 0.0078125 && accuracy->error95 == 0.015625);
    assert_int_equal(accuracy->audit_rays, 64);
    assert_string_equal(accuracy->method, "cached");
    assert_int_equal(accuracy->plan, 12);
    assert_true(accuracy->has_cut_share && accuracy->cut_share == 0.125);
    assert_true(accuracy->traced == 0.0625);
}

static inline bool commit(struct store *store, struct store_op *ops, size_t count, struct error *error)
{
    bool ok = store_commit(store, ops, count, error);

    for (size_t i = 0; i < count; i++)
        store_op_finish(&ops[i]);
    return ok;
}

static inline void commit_one(struct store *store, struct store_op op)
{
    struct error error = {0};

    if (!commit(store, &op, 1, &error)) fail_msg("%s", error.message);
}

// The last rows of a load, and counts.
struct loaded {
    int jobs, frames;
    struct store_job job;
    char text[256];
    struct store_frame frame;
    int64_t index_sum;
};

static inline bool on_job(void *user, const struct store_job *job, struct error *error)
{
    struct loaded *loaded = user;

    loaded->jobs++;
    loaded->job = *job;
    snprintf(loaded->text, sizeof loaded->text, "%s %s %s %s %s", job->document, job->name, job->owner, job->root,
             job->reason ? job->reason : "-");
    return true;
}

static inline bool on_frame(void *user, const struct store_frame *frame, struct error *error)
{
    struct loaded *loaded = user;

    loaded->frames++;
    loaded->frame = *frame;
    loaded->index_sum += frame->index;
    return true;
}

static inline struct loaded load(struct store *store)
{
    struct loaded loaded = {0};
    struct error error = {0};

    if (!store_load(store, on_job, on_frame, &loaded, &error)) fail_msg("%s", error.message);
    return loaded;
}
