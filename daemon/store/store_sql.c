// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_sql.h"

#include "core/base/error.h"

#include <errno.h>
#include <sqlite3.h>
#include <string.h>

static int last_errno_of(sqlite3 *db, int file_opcode)
{
    sqlite3_file *file = NULL;
    int errnum = 0;

    sqlite3_file_control(db, NULL, file_opcode, &file);
    if (file && file->pMethods) file->pMethods->xFileControl(file, SQLITE_FCNTL_LAST_ERRNO, &errnum);
    return errnum;
}

// A failed COMMIT leaves its errno not in the connection but in the file on which it failed.
static int find_errno(sqlite3 *db)
{
    int errnum = sqlite3_system_errno(db);

    if (!errnum) errnum = last_errno_of(db, SQLITE_FCNTL_JOURNAL_POINTER);
    return errnum ? errnum : last_errno_of(db, SQLITE_FCNTL_FILE_POINTER);
}

bool store_sql_is_full(sqlite3 *db)
{
    int code = sqlite3_errcode(db), errnum = find_errno(db);

    return code == SQLITE_FULL ||
           ((code == SQLITE_IOERR || code == SQLITE_CANTOPEN) && (errnum == ENOSPC || errnum == EDQUOT));
}

bool store_sql_is_readable(sqlite3 *db)
{
    sqlite3_stmt *statement = NULL;
    // SQLITE_ERROR: a name in the schema is another.
    bool ok = sqlite3_errcode(db) != SQLITE_ERROR &&
              sqlite3_prepare_v2(db, "PRAGMA quick_check(1)", -1, &statement, NULL) == SQLITE_OK &&
              sqlite3_step(statement) == SQLITE_ROW && strcmp(store_sql_text(statement, 0), "ok") == 0;

    sqlite3_finalize(statement);
    return ok;
}

static const char *describe_cause(sqlite3 *db)
{
    int errnum = find_errno(db);

    if (store_sql_is_full(db)) return "disk full";
    switch (sqlite3_errcode(db)) {
    case SQLITE_IOERR:
        return errnum ? strerrordesc_np(errnum) : sqlite3_errmsg(db);
    case SQLITE_NOTADB:
        return "queue.db is no SQLite database, or its start is damaged";
    case SQLITE_CORRUPT:
        return "queue.db is damaged: restore a backup (march restore)";
    case SQLITE_BUSY:
        return "queue.db is locked by another program";
    case SQLITE_CANTOPEN:
        return errnum ? strerrordesc_np(errnum) : sqlite3_errmsg(db);
    default:
        return sqlite3_errmsg(db);
    }
}

void store_sql_set_error(struct error *error, sqlite3 *db, const char *what)
{
    error_set(error, "store: cannot %s: %s", what, describe_cause(db));
}

bool store_sql_execute(sqlite3 *db, const char *sql, const char *what, struct error *error)
{
    if (sqlite3_exec(db, sql, NULL, NULL, NULL) == SQLITE_OK) return true;
    store_sql_set_error(error, db, what);
    return false;
}

bool store_sql_read_integer(sqlite3 *db, const char *sql, int64_t *integer, struct error *error)
{
    sqlite3_stmt *statement = NULL;
    bool ok = false;

    if (!store_sql_prepare(db, sql, &statement, error)) goto out;
    if (sqlite3_step(statement) != SQLITE_ROW) {
        store_sql_set_error(error, db, "read");
        goto out;
    }
    *integer = sqlite3_column_int64(statement, 0);
    ok = true;
out:
    sqlite3_finalize(statement);
    return ok;
}

bool store_sql_prepare(sqlite3 *db, const char *sql, sqlite3_stmt **statement, struct error *error)
{
    if (sqlite3_prepare_v3(db, sql, -1, SQLITE_PREPARE_PERSISTENT, statement, NULL) == SQLITE_OK) return true;
    store_sql_set_error(error, db, "read");
    return false;
}

bool store_sql_run(sqlite3_stmt *statement, const char *what, struct error *error)
{
    bool ok = sqlite3_step(statement) == SQLITE_DONE;

    if (!ok) store_sql_set_error(error, sqlite3_db_handle(statement), what);
    sqlite3_reset(statement);
    return ok;
}

void store_sql_bind_text(sqlite3_stmt *statement, int parameter, const char *text)
{
    sqlite3_bind_text(statement, parameter, text, -1, SQLITE_STATIC);
}

char *store_sql_text(sqlite3_stmt *statement, int column)
{
    return (char *)sqlite3_column_text(statement, column);
}
