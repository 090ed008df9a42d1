// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_notices.h"

#include "core/base/alloc.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sql.h"

#include <sqlite3.h>
#include <stdlib.h>

enum { ADD, DROP, SET_TOLD, FORGET_TOLD, STATEMENT_COUNT };

static const char *const statement_texts[STATEMENT_COUNT] = {
    [ADD] = "INSERT INTO notice (" STORE_SCHEMA_NOTICE_COLUMNS ", sum) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8,"
            " row_sum(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8))",
    [DROP] = "DELETE FROM notice WHERE id = ?",
    [SET_TOLD] = "REPLACE INTO told (" STORE_SCHEMA_TOLD_COLUMNS ", sum) VALUES (?1, ?2, ?3, ?4,"
                 " row_sum(?1, ?2, ?3, ?4))",
    [FORGET_TOLD] = "DELETE FROM told WHERE job = ?",
};

struct store_notices {
    sqlite3_stmt *statements[STATEMENT_COUNT]; // owned
};

struct store_notices *store_notices_create(sqlite3 *db, struct error *error)
{
    struct store_notices *notices = xcalloc(1, sizeof *notices);

    for (int i = 0; i < STATEMENT_COUNT; i++) {
        if (store_sql_prepare(db, statement_texts[i], &notices->statements[i], error)) continue;
        store_notices_destroy(notices);
        return NULL;
    }
    return notices;
}

void store_notices_destroy(struct store_notices *notices)
{
    if (!notices) return;
    for (int i = 0; i < STATEMENT_COUNT; i++)
        sqlite3_finalize(notices->statements[i]);
    free(notices);
}

static bool add(sqlite3_stmt *statement, const struct store_notice *notice, struct error *error)
{
    sqlite3_bind_int64(statement, 1, notice->id);
    sqlite3_bind_int64(statement, 2, notice->job);
    sqlite3_bind_int64(statement, 3, notice->owner_uid);
    sqlite3_bind_int64(statement, 4, notice->made_ms);
    store_sql_bind_text(statement, 5, notice->event);
    store_sql_bind_text(statement, 6, notice->target);
    sqlite3_bind_int(statement, 7, notice->is_webhook);
    store_sql_bind_text(statement, 8, notice->body);
    return store_sql_run(statement, "add a notice", error);
}

static bool set_told(sqlite3_stmt *statement, const struct store_told *told, struct error *error)
{
    sqlite3_bind_int64(statement, 1, told->job);
    sqlite3_bind_int(statement, 2, told->cause);
    sqlite3_bind_int64(statement, 3, told->told_ms);
    sqlite3_bind_int(statement, 4, told->is_on);
    return store_sql_run(statement, "note what a job told", error);
}

bool store_notices_apply(struct store_notices *notices, const struct store_op *op, struct error *error)
{
    switch (op->kind) {
    case STORE_ADD_NOTICE:
        return add(notices->statements[ADD], &op->notice, error);
    case STORE_DROP_NOTICE:
        sqlite3_bind_int64(notices->statements[DROP], 1, op->notice.id);
        return store_sql_run(notices->statements[DROP], "drop a notice", error);
    case STORE_SET_TOLD:
        return set_told(notices->statements[SET_TOLD], &op->told, error);
    default:
        return false;
    }
}

bool store_notices_forget_job(struct store_notices *notices, int64_t job, struct error *error)
{
    sqlite3_bind_int64(notices->statements[FORGET_TOLD], 1, job);
    return store_sql_run(notices->statements[FORGET_TOLD], "delete a job", error);
}

static struct store_notice notice_of(sqlite3_stmt *row)
{
    return (struct store_notice){.id = sqlite3_column_int64(row, 0),
                                 .job = sqlite3_column_int64(row, 1),
                                 .owner_uid = sqlite3_column_int64(row, 2),
                                 .made_ms = sqlite3_column_int64(row, 3),
                                 .event = store_sql_text(row, 4),
                                 .target = store_sql_text(row, 5),
                                 .is_webhook = sqlite3_column_int(row, 6) != 0,
                                 .body = store_sql_text(row, 7)};
}

static bool read_notices(sqlite3 *db, const char *sql, int64_t after, int limit, store_on_notice *on_notice, void *user,
                         struct error *error)
{
    sqlite3_stmt *rows = NULL;
    bool ok = true;
    int result = SQLITE_DONE;

    if (!store_sql_prepare(db, sql, &rows, error)) return false;
    sqlite3_bind_int64(rows, 1, after);
    sqlite3_bind_int(rows, 2, limit);
    while (ok && (result = sqlite3_step(rows)) == SQLITE_ROW) {
        const struct store_notice notice = notice_of(rows);

        ok = on_notice(user, &notice, error);
    }
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, db, "read notices");
        ok = false;
    }
    sqlite3_finalize(rows);
    return ok;
}

bool store_notices_read(sqlite3 *db, int64_t after, int limit, store_on_notice *on_notice, void *user,
                        struct error *error)
{
    return read_notices(db,
                        "SELECT " STORE_SCHEMA_NOTICE_COLUMNS " FROM notice WHERE id > ?1"
                        " AND sum IS row_sum(" STORE_SCHEMA_NOTICE_COLUMNS ") ORDER BY id LIMIT ?2",
                        after, limit, on_notice, user, error);
}

bool store_notices_list(sqlite3 *db, store_on_notice *on_notice, void *user, struct error *error)
{
    return read_notices(db,
                        "SELECT id, job, owner_uid, made_ms, event, target, is_webhook, NULL FROM notice"
                        " WHERE id > ?1 ORDER BY id LIMIT ?2",
                        0, -1, on_notice, user, error);
}

bool store_notices_read_told(sqlite3 *db, store_on_told *on_told, void *user, struct error *error)
{
    sqlite3_stmt *rows = NULL;
    bool ok = true;
    int result = SQLITE_DONE;

    if (!store_sql_prepare(db, "SELECT " STORE_SCHEMA_TOLD_COLUMNS " FROM told ORDER BY job, cause", &rows, error))
        return false;
    while (ok && (result = sqlite3_step(rows)) == SQLITE_ROW) {
        const struct store_told told = {.job = sqlite3_column_int64(rows, 0),
                                        .cause = sqlite3_column_int(rows, 1),
                                        .told_ms = sqlite3_column_int64(rows, 2),
                                        .is_on = sqlite3_column_int(rows, 3) != 0};

        ok = on_told(user, &told, error);
    }
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, db, "read what jobs told");
        ok = false;
    }
    sqlite3_finalize(rows);
    return ok;
}
