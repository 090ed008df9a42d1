// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/store_backup.h"
#include "daemon/store/store_counts.h"
#include "daemon/store/store_load.h"
#include "daemon/store/store_lock.h"
#include "daemon/store/store_marks.h"
#include "daemon/store/store_notices.h"
#include "daemon/store/store_place.h"
#include "daemon/store/store_repair.h"
#include "daemon/store/store_reserve.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sql.h"
#include "daemon/store/store_sum.h"
#include "daemon/store/store_tokens.h"

#include <inttypes.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <unistd.h>

enum { BUSY_TIMEOUT_MS = 5000 };

enum statement {
    BEGIN,
    COMMIT,
    PROBE,
    ADD_JOB,
    ADD_DOCUMENT,
    SET_JOB,
    SET_FRAME,
    RESET_FRAMES,
    SET_MARKS,
    DROP_MARKS,
    ADD_ATTEMPT,
    TRIM_ATTEMPTS,
    ADD_PLAN,
    TRIM_PLANS,
    SET_ROOT,
    SET_USAGE,
    KEEP_ID,
    DELETE_JOB,
    DELETE_DOCUMENT,
    DELETE_FRAMES,
    DELETE_MARKS,
    DELETE_ATTEMPTS,
    STATEMENT_COUNT
};

static const char *const statement_texts[STATEMENT_COUNT] = {
    [BEGIN] = "BEGIN IMMEDIATE",
    [COMMIT] = "COMMIT",
    [PROBE] = "UPDATE daemon SET epoch = epoch + 1, sum = row_sum(epoch + 1, last_job_id, farm)",
    [ADD_JOB] = "INSERT INTO job (id, priority, is_paused, is_canceled, is_failed, submitted_ms, started_ms,"
                " finished_ms, reason, name, owner, owner_uid, root, waits, sum) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, "
                "?8, ?9, ?10,"
                " ?11, ?12, ?13, ?14, row_sum(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14))",
    [ADD_DOCUMENT] = "INSERT INTO document (job, text, sum) VALUES (?1, ?2, row_sum(?1, ?2))",
    [SET_JOB] =
        "UPDATE job SET priority = ?2, is_paused = ?3, is_canceled = ?4, is_failed = ?5, submitted_ms = ?6,"
        " started_ms = ?7, finished_ms = ?8, reason = ?9, name = coalesce(?10, name), owner = coalesce(?11, owner),"
        " owner_uid = coalesce(?12, owner_uid), root = coalesce(?13, root), waits = ?14,"
        " sum = row_sum(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, coalesce(?10, name), coalesce(?11, owner),"
        " coalesce(?12, owner_uid), coalesce(?13, root), ?14) WHERE id = ?1",
    [SET_FRAME] = "REPLACE INTO frame (" STORE_SCHEMA_FRAME_COLUMNS ", sum) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8,"
                  " ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, row_sum(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8,"
                  " ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20))",
    [RESET_FRAMES] = "DELETE FROM frame WHERE job = ? AND frame_index BETWEEN ? AND ?",
    [SET_MARKS] = store_marks_set_sql,
    [DROP_MARKS] = store_marks_drop_sql,
    [ADD_ATTEMPT] = "INSERT INTO attempt (job, number, frame, attempt, worker, ended_ms, outcome, log, sum)"
                    " SELECT ?1, number, ?2, ?3, ?4, ?5, ?6, ?7, row_sum(?1, number, ?2, ?3, ?4, ?5, ?6, ?7) FROM"
                    " (SELECT coalesce((SELECT number FROM attempt WHERE job = ?1 ORDER BY number DESC LIMIT 1), 0)"
                    " + 1 AS number)",
    [TRIM_ATTEMPTS] = "DELETE FROM attempt WHERE job = ?1 AND number <="
                      " (SELECT number FROM attempt WHERE job = ?1 ORDER BY number DESC LIMIT 1) - ?2",
    [ADD_PLAN] = "INSERT INTO plan (number, owner_uid, scene, segment, text, sum)"
                 " VALUES (?1, ?2, ?3, ?4, ?5, row_sum(?1, ?2, ?3, ?4, ?5))",
    [TRIM_PLANS] = "DELETE FROM plan WHERE owner_uid = ?1 AND number <="
                   " (SELECT number FROM plan WHERE owner_uid = ?1 ORDER BY number DESC LIMIT 1 OFFSET ?2)",
    [SET_ROOT] = "REPLACE INTO root (path, id, sum) VALUES (?1, ?2, row_sum(?1, ?2))",
    [SET_USAGE] = "REPLACE INTO usage (owner_uid, used_s, at_ms, sum) VALUES (?1, ?2, ?3, row_sum(?1, ?2, ?3))",
    [KEEP_ID] = "UPDATE daemon SET last_job_id = max(last_job_id, ?1),"
                " sum = row_sum(epoch, max(last_job_id, ?1), farm)",
    [DELETE_JOB] = "DELETE FROM job WHERE id = ?",
    [DELETE_DOCUMENT] = "DELETE FROM document WHERE job = ?",
    [DELETE_FRAMES] = "DELETE FROM frame WHERE job = ?",
    [DELETE_MARKS] = "DELETE FROM mark WHERE job = ?",
    [DELETE_ATTEMPTS] = "DELETE FROM attempt WHERE job = ?",
};

struct store {
    char *folder; // owned
    int lock_fd;
    sqlite3 *db; // owned
    struct store_place place;
    sqlite3_stmt *statements[STATEMENT_COUNT]; // owned
    struct store_notices *notices;             // owned
    int64_t epoch;
    int64_t next_job_id;
    int64_t next_plan_number;
    int64_t uncounted_id; // of a job that was refused because its id could not be counted; 0: none
    bool has_reserve;
    bool is_full;       // the latest failure was a full disk
    bool is_unreadable; // SQLite cannot read all of the file
};

// The epoch and the ids go on above those that the folder knows of: the store may come from a backup.
static bool count_start(struct store *store, struct error *error)
{
    struct store_counts known;
    char *sql;
    bool ok;

    store_counts_read(store->folder, &known);
    sql = xasprintf("BEGIN IMMEDIATE; UPDATE daemon SET epoch = max(epoch, %" PRId64 ") + 1,"
                    " last_job_id = max(last_job_id, %" PRId64 ");"
                    "UPDATE daemon SET sum = row_sum(" STORE_SCHEMA_DAEMON_COLUMNS "); COMMIT",
                    known.epoch, known.last_job_id);
    ok = store_sql_execute(store->db, sql, "count this start", error);
    free(sql);
    return ok;
}

// Writes nothing before the database is known to be a store; then the tables and the new epoch are one transaction.
static bool open_database(struct store *store, const char *path, struct error *error)
{
    int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX;
    int64_t last_id = 0;
    int found;

    if (sqlite3_open_v2(path, &store->db, flags, NULL) != SQLITE_OK) {
        store_sql_set_error(error, store->db, "open queue.db");
        return false;
    }
    // A store that is refused keeps its write-ahead log as well.
    sqlite3_db_config(store->db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
    sqlite3_busy_timeout(store->db, BUSY_TIMEOUT_MS);
    if (!store_sum_register(store->db, error) || !store_schema_check(store->db, &found, error)) return false;
    sqlite3_db_config(store->db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 0, NULL);

    if (!store_sql_execute(store->db, "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; BEGIN IMMEDIATE",
                           "write to queue.db", error))
        return false;
    if (!store_schema_upgrade(store->db, found, error)) return false;
    if (!store_sql_execute(store->db, "COMMIT", "make the tables", error)) return false;
    if (!store_repair(store->db, store->folder, NULL, error) || !count_start(store, error)) return false;
    if (!store_sql_read_integer(store->db, "SELECT epoch FROM daemon", &store->epoch, error)) return false;
    if (!store_sql_read_integer(
            store->db, "SELECT max(last_job_id, (SELECT coalesce(max(id), 0) FROM job)) FROM daemon", &last_id, error))
        return false;
    store->next_job_id = last_id + 1;
    // Where that fails, the ids of the next jobs are counted, or the jobs refused.
    store_counts_raise(store->folder, &(struct store_counts){.last_job_id = last_id, .epoch = store->epoch}, NULL);
    // The newest plan of an owner is never dropped.
    if (!store_sql_read_integer(store->db, "SELECT coalesce(max(number), 0) + 1 FROM plan", &store->next_plan_number,
                                error))
        return false;
    return true;
}

static bool try_to_open(struct store *store, struct error *error)
{
    char *path = xasprintf("%s/queue.db", store->folder);
    bool ok = open_database(store, path, error);

    store->is_full = !ok && store_sql_is_full(store->db);
    store->is_unreadable = !ok && !store->is_full && !store_sql_is_readable(store->db);
    if (!ok) {
        sqlite3_close(store->db);
        store->db = NULL;
    }
    free(path);
    return ok;
}

struct store *store_open(const char *folder, bool *is_full, struct error *error)
{
    struct store *store = xcalloc(1, sizeof *store);
    bool ok = false;

    store->folder = xstrdup(folder);
    store->lock_fd = store_lock_take(folder, STORE_LOCK_WAIT_MS, error);
    if (store->lock_fd < 0 || !store_backup_end_restore(folder, error)) goto out;
    ok = try_to_open(store, error);
    if (!ok && store->is_full && store_reserve_release(folder)) ok = try_to_open(store, error);
    if (!ok && store->is_unreadable && store_backup_fall_back(folder, NULL)) ok = try_to_open(store, error);
    if (!ok) goto out;
    ok = false;
    for (int i = 0; i < STATEMENT_COUNT; i++)
        if (!store_sql_prepare(store->db, statement_texts[i], &store->statements[i], error)) goto out;
    store->notices = store_notices_create(store->db, error);
    if (!store->notices) goto out;
    store_place_note(&store->place, folder);
    store->has_reserve = store_reserve_make(folder, NULL);
    ok = true;
out:
    if (is_full) *is_full = store->is_full;
    if (ok) return store;
    store_close(store);
    return NULL;
}

void store_close(struct store *store)
{
    if (!store) return;
    for (int i = 0; i < STATEMENT_COUNT; i++)
        sqlite3_finalize(store->statements[i]);
    store_notices_destroy(store->notices);
    sqlite3_close(store->db);
    if (store->lock_fd >= 0) close(store->lock_fd);
    free(store->folder);
    free(store);
}

int64_t store_epoch(const struct store *store)
{
    return store->epoch;
}

int64_t store_next_job_id(const struct store *store)
{
    return store->next_job_id;
}

int64_t store_next_plan_number(const struct store *store)
{
    return store->next_plan_number;
}

static void bind_job_changes(sqlite3_stmt *statement, const struct store_job *job)
{
    sqlite3_bind_int64(statement, 1, job->id);
    sqlite3_bind_int(statement, 2, job->priority);
    sqlite3_bind_int(statement, 3, job->is_paused);
    sqlite3_bind_int(statement, 4, job->is_canceled);
    sqlite3_bind_int(statement, 5, job->is_failed);
    sqlite3_bind_int64(statement, 6, job->submitted_ms);
    sqlite3_bind_int64(statement, 7, job->started_ms);
    sqlite3_bind_int64(statement, 8, job->finished_ms);
    store_sql_bind_text(statement, 9, job->reason);
}

static void bind_job_rest(sqlite3_stmt *statement, const struct store_job *job)
{
    store_sql_bind_text(statement, 10, job->name);
    store_sql_bind_text(statement, 11, job->owner);
    sqlite3_bind_int64(statement, 12, job->owner_uid);
    store_sql_bind_text(statement, 13, job->root);
    sqlite3_bind_null(statement, 14);
    if (job->waits) sqlite3_bind_int(statement, 14, 1);
}

static bool add_job(struct store *store, const struct store_job *job, struct error *error)
{
    sqlite3_stmt *add = store->statements[ADD_JOB];
    sqlite3_stmt *document = store->statements[ADD_DOCUMENT];

    bind_job_changes(add, job);
    bind_job_rest(add, job);
    sqlite3_bind_int64(document, 1, job->id);
    store_sql_bind_text(document, 2, job->document);
    return store_sql_run(add, "add a job", error) && store_sql_run(document, "add a job", error);
}

static bool set_job(struct store *store, const struct store_job *job, struct error *error)
{
    bind_job_changes(store->statements[SET_JOB], job);
    bind_job_rest(store->statements[SET_JOB], job);
    if (!job->owner) sqlite3_bind_null(store->statements[SET_JOB], 12);
    if (!store_sql_run(store->statements[SET_JOB], "change a job", error)) return false;
    if (sqlite3_changes(store->db) == 1) return true;
    error_set(error, "store: cannot change job %" PRId64 ": the store has no such job", job->id);
    return false;
}

static void bind_accuracy(sqlite3_stmt *statement, const struct frame_accuracy *accuracy)
{
    for (int column = 12; column <= 19; column++)
        sqlite3_bind_null(statement, column);
    if (accuracy->audit[0]) {
        store_sql_bind_text(statement, 12, accuracy->audit);
        sqlite3_bind_double(statement, 13, accuracy->error);
        sqlite3_bind_double(statement, 14, accuracy->error95);
        sqlite3_bind_int(statement, 15, accuracy->audit_rays);
        store_sql_bind_text(statement, 16, accuracy->method);
    }
    if (accuracy->has_cut_share) sqlite3_bind_double(statement, 17, accuracy->cut_share);
    if (accuracy->plan > 0) sqlite3_bind_int64(statement, 18, accuracy->plan);
    if (accuracy->traced > 0.0) sqlite3_bind_double(statement, 19, accuracy->traced);
}

static bool set_frame(struct store *store, const struct store_frame *frame, struct error *error)
{
    sqlite3_stmt *statement = store->statements[SET_FRAME];

    sqlite3_bind_int64(statement, 1, frame->job);
    sqlite3_bind_int(statement, 2, frame->index);
    sqlite3_bind_int(statement, 3, frame->state);
    sqlite3_bind_int(statement, 4, frame->attempts);
    sqlite3_bind_int64(statement, 5, frame->epoch);
    sqlite3_bind_int64(statement, 6, (int64_t)frame->inode);
    sqlite3_bind_int64(statement, 7, (int64_t)frame->size_bytes);
    store_sql_bind_text(statement, 8, frame->hash[0] ? frame->hash : NULL);
    sqlite3_bind_double(statement, 9, frame->render_s);
    sqlite3_bind_double(statement, 10, frame->encode_s);
    store_sql_bind_text(statement, 11, frame->error);
    bind_accuracy(statement, &frame->accuracy);
    sqlite3_bind_double(statement, 20, frame->audit_s);
    return store_sql_run(statement, "write a frame", error);
}

static bool add_attempt(struct store *store, const struct store_attempt *attempt, struct error *error)
{
    sqlite3_stmt *add = store->statements[ADD_ATTEMPT];
    sqlite3_stmt *trim = store->statements[TRIM_ATTEMPTS];

    sqlite3_bind_int64(add, 1, attempt->job);
    sqlite3_bind_int(add, 2, attempt->frame);
    sqlite3_bind_int(add, 3, attempt->attempt);
    sqlite3_bind_int(add, 4, attempt->worker);
    sqlite3_bind_int64(add, 5, attempt->ended_ms);
    store_sql_bind_text(add, 6, attempt->outcome);
    store_sql_bind_text(add, 7, attempt->log);
    sqlite3_bind_int64(trim, 1, attempt->job);
    sqlite3_bind_int(trim, 2, STORE_ATTEMPT_LIMIT);
    return store_sql_run(add, "add an attempt", error) && store_sql_run(trim, "drop old attempts", error);
}

static bool add_plan(struct store *store, const struct store_plan *plan, struct error *error)
{
    sqlite3_stmt *add = store->statements[ADD_PLAN];
    sqlite3_stmt *trim = store->statements[TRIM_PLANS];

    sqlite3_bind_int64(add, 1, plan->number);
    sqlite3_bind_int64(add, 2, plan->key.owner_uid);
    store_sql_bind_text(add, 3, plan->key.scene);
    store_sql_bind_text(add, 4, plan->key.segment);
    store_sql_bind_text(add, 5, plan->text);
    sqlite3_bind_int64(trim, 1, plan->key.owner_uid);
    sqlite3_bind_int(trim, 2, STORE_PLAN_LIMIT);
    return store_sql_run(add, "add a plan", error) && store_sql_run(trim, "drop old plans", error);
}

// Each run of consecutive indices is deleted by one statement.
static bool reset_frames(struct store *store, int64_t job, const int32_t *indices, size_t count, struct error *error)
{
    sqlite3_stmt *statement = store->statements[RESET_FRAMES];

    for (size_t first = 0, next; first < count; first = next) {
        for (next = first + 1; next < count && indices[next] == indices[next - 1] + 1;)
            next++;
        sqlite3_bind_int64(statement, 1, job);
        sqlite3_bind_int(statement, 2, indices[first]);
        sqlite3_bind_int(statement, 3, indices[next - 1]);
        if (!store_sql_run(statement, "queue frames again", error)) return false;
    }
    return true;
}

static bool set_root(struct store *store, const struct store_root *root, struct error *error)
{
    store_sql_bind_text(store->statements[SET_ROOT], 1, root->path);
    store_sql_bind_text(store->statements[SET_ROOT], 2, root->id);
    return store_sql_run(store->statements[SET_ROOT], "write an output root", error);
}

static bool set_usage(struct store *store, const struct store_usage *usage, struct error *error)
{
    sqlite3_bind_int64(store->statements[SET_USAGE], 1, usage->owner_uid);
    sqlite3_bind_double(store->statements[SET_USAGE], 2, usage->used_s);
    sqlite3_bind_int64(store->statements[SET_USAGE], 3, usage->at_ms);
    return store_sql_run(store->statements[SET_USAGE], "write an owner's use", error);
}

static bool delete_job(struct store *store, int64_t job, struct error *error)
{
    for (int i = KEEP_ID; i <= DELETE_ATTEMPTS; i++) {
        sqlite3_bind_int64(store->statements[i], 1, job);
        if (!store_sql_run(store->statements[i], "delete a job", error)) return false;
    }
    return store_notices_forget_job(store->notices, job, error);
}

static bool apply(struct store *store, const struct store_op *op, struct error *error)
{
    switch (op->kind) {
    case STORE_ADD_JOB:
        return add_job(store, &op->job, error);
    case STORE_SET_JOB:
        return set_job(store, &op->job, error);
    case STORE_DELETE_JOB:
        return delete_job(store, op->job.id, error);
    case STORE_SET_FRAME:
        return set_frame(store, &op->frame, error);
    case STORE_ADD_ATTEMPT:
        return add_attempt(store, &op->attempt, error);
    case STORE_ADD_PLAN:
        return add_plan(store, &op->plan, error);
    case STORE_SET_ROOT:
        return set_root(store, &op->root, error);
    case STORE_SET_USAGE:
        return set_usage(store, &op->usage, error);
    case STORE_SET_TOKEN:
        return store_tokens_set(store->db, &op->token, error);
    case STORE_DELETE_TOKEN:
        return store_tokens_delete(store->db, op->token.id, error);
    case STORE_RESET_FRAMES:
        return reset_frames(store, op->reset.job, op->reset.indices, op->reset.count, error);
    case STORE_SET_MARKS:
        return store_marks_set(store->statements[SET_MARKS], store->statements[DROP_MARKS], op, error);
    case STORE_ADD_NOTICE:
    case STORE_DROP_NOTICE:
    case STORE_SET_TOLD:
        return store_notices_apply(store->notices, op, error);
    }
    return false;
}

static int64_t next_id_after(const struct store *store, const struct store_op *ops, size_t op_count)
{
    int64_t next_id = store->next_job_id;

    for (size_t i = 0; i < op_count; i++)
        if (ops[i].kind == STORE_ADD_JOB && ops[i].job.id >= next_id) next_id = ops[i].job.id + 1;
    return next_id;
}

static bool try_to_commit(struct store *store, const struct store_op *ops, size_t op_count, struct error *error)
{
    bool ok = false;

    store->is_full = false;
    if (!store_place_check(&store->place, store->folder, store->db, error)) return false;
    if (!store_sql_run(store->statements[BEGIN], "begin", error)) goto out;
    for (size_t i = 0; i < op_count; i++)
        if (!apply(store, &ops[i], error)) goto out;
    ok = store_sql_run(store->statements[COMMIT], "commit", error);
out:
    store->is_full = !ok && store_sql_is_full(store->db);
    // After some failures SQLite has rolled back already.
    if (!ok && !sqlite3_get_autocommit(store->db)) sqlite3_exec(store->db, "ROLLBACK", NULL, NULL, NULL);
    return ok;
}

static bool commit_with_reserve(struct store *store, const struct store_op *ops, size_t op_count, struct error *error)
{
    if (try_to_commit(store, ops, op_count, error)) return true;
    if (!store->is_full || !store_reserve_release(store->folder)) return false;
    store->has_reserve = false;
    return try_to_commit(store, ops, op_count, error);
}

static bool count_id(struct store *store, int64_t id, struct error *error)
{
    const struct store_counts counts = {.last_job_id = id, .epoch = store->epoch};
    bool ok = store_counts_raise(store->folder, &counts, error);

    store->uncounted_id = ok ? 0 : id;
    return ok;
}

// An id is counted before its job is there: a store that is restored from a backup does not give it again.
bool store_commit(struct store *store, const struct store_op *ops, size_t op_count, struct error *error)
{
    int64_t next_id = next_id_after(store, ops, op_count);

    if (op_count == 0) return true;
    if (next_id > store->next_job_id && !count_id(store, next_id - 1, error)) return false;
    if (!commit_with_reserve(store, ops, op_count, error)) return false;
    store->next_job_id = next_id;
    return true;
}

bool store_is_full(const struct store *store)
{
    return store->is_full;
}

bool store_has_reserve(const struct store *store)
{
    return store->has_reserve;
}

bool store_probe(struct store *store, struct error *error)
{
    if (!store->has_reserve) store->has_reserve = store_reserve_make(store->folder, error);
    if (store->uncounted_id > 0 && !count_id(store, store->uncounted_id, error)) return false;
    return store->has_reserve && store_place_check(&store->place, store->folder, store->db, error) &&
           store_sql_run(store->statements[PROBE], "commit", error);
}

bool store_load(struct store *store, store_on_job *on_job, store_on_frame *on_frame, void *user, struct error *error)
{
    return store_load_rows(store->db, on_job, on_frame, user, error);
}
