// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_repair.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/log.h"
#include "daemon/store/store_backup.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sql.h"
#include "daemon/store/store_sum.h"

#include <sqlite3.h>
#include <stdlib.h>
#include <unistd.h>

enum { LINE_LIMIT = 20, EPOCH_JUMP = 1000 };

// Without a backup, and with one of another version, an empty one stands in for it.
static bool attach_backup(sqlite3 *db, const char *folder, struct error *error)
{
    char *path = xasprintf("%s/" STORE_BACKUP_NAME, folder);
    char *sql = sqlite3_mprintf("ATTACH %Q AS kept", access(path, R_OK) == 0 ? path : ":memory:");
    int64_t version = 0;
    bool ok = store_sql_execute(db, sql, "open the backup", NULL) &&
              store_sql_read_integer(db, "PRAGMA kept.user_version", &version, NULL);

    if (!ok || version != STORE_SCHEMA_VERSION) {
        sqlite3_exec(db, "DETACH kept", NULL, NULL, NULL);
        ok = store_sql_execute(db, "ATTACH ':memory:' AS kept", "go without a backup", error);
        for (const struct store_table *table = store_tables; table->name && ok; table++) {
            char *empty = xasprintf("CREATE TABLE kept.%s AS SELECT * FROM main.%s WHERE 0", table->name, table->name);

            ok = store_sql_execute(db, empty, "go without a backup", error);
            free(empty);
        }
    }
    sqlite3_free(sql);
    free(path);
    return ok;
}

// Columns of a row, and whether the backup has it whole: as text, for the log.
static char *format_report_sql(const struct store_table *table)
{
    const char *key = table->key ? table->key : "1";

    return xasprintf("SELECT concat_keys(%s), (%s) IN (SELECT %s FROM kept.%s WHERE sum IS row_sum(%s)) FROM main.%s"
                     " WHERE sum IS NOT row_sum(%s)",
                     key, key, key, table->name, table->columns, table->name, table->columns);
}

static void report_row(const struct store_table *table, const char *key, bool is_restored)
{
    log_error("store: a damaged row of queue.db (%s %s): %s%s", table->name, key,
              is_restored ? "restored from the backup" : "no backup has it, ", is_restored ? "" : table->if_lost);
}

static bool report(sqlite3 *db, const struct store_table *table, int64_t *count, struct error *error)
{
    char *sql = format_report_sql(table);
    sqlite3_stmt *rows = NULL;
    bool ok = store_sql_prepare(db, sql, &rows, error);
    int result = SQLITE_DONE;

    while (ok && (result = sqlite3_step(rows)) == SQLITE_ROW)
        if ((*count)++ < LINE_LIMIT) report_row(table, store_sql_text(rows, 0), sqlite3_column_int(rows, 1) != 0);
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, db, "look for damaged rows");
        ok = false;
    }
    sqlite3_finalize(rows);
    free(sql);
    return ok;
}

static bool mend_table(sqlite3 *db, const struct store_table *table, struct error *error)
{
    const char *name = table->name, *columns = table->columns, *key = table->key;
    char *restore = xasprintf("REPLACE INTO main.%s (%s, sum) SELECT %s, sum FROM kept.%s WHERE sum IS row_sum(%s)"
                              " AND (%s) IN (SELECT %s FROM main.%s WHERE sum IS NOT row_sum(%s))",
                              name, columns, columns, name, columns, key, key, name, columns);
    char *drop = xasprintf("DELETE FROM main.%s WHERE sum IS NOT row_sum(%s)", name, columns);
    bool ok = store_sql_execute(db, restore, "restore rows", error) &&
              (!table->may_be_dropped || store_sql_execute(db, drop, "drop damaged rows", error));

    free(restore);
    free(drop);
    return ok;
}

// The epoch must be greater than any that a part file may have.
static bool mend_daemon(sqlite3 *db, struct error *error)
{
    const char *good = " FROM kept.daemon WHERE sum IS row_sum(" STORE_SCHEMA_DAEMON_COLUMNS ")";
    char *sql = xasprintf("UPDATE main.daemon SET last_job_id = coalesce((SELECT last_job_id%s), 0),"
                          " farm = coalesce((SELECT farm%s), farm), epoch = %d + max(coalesce((SELECT epoch%s), 0),"
                          " (SELECT coalesce(max(epoch), 0) FROM main.frame))"
                          " WHERE sum IS NOT row_sum(" STORE_SCHEMA_DAEMON_COLUMNS ");"
                          "UPDATE main.daemon SET sum = row_sum(" STORE_SCHEMA_DAEMON_COLUMNS ")",
                          good, good, EPOCH_JUMP, good);
    bool ok = store_sql_execute(db, sql, "mend the row of the daemon", error);

    free(sql);
    return ok;
}

// A row whose key was damaged is no longer where it belongs: its job lacks it.
static bool mend_lost(sqlite3 *db, int64_t *count, struct error *error)
{
    static const char sql[] =
        "INSERT OR IGNORE INTO main.job (" STORE_SCHEMA_JOB_COLUMNS ", sum) SELECT " STORE_SCHEMA_JOB_COLUMNS ", sum"
        " FROM kept.job WHERE sum IS row_sum(" STORE_SCHEMA_JOB_COLUMNS ")"
        " AND id IN (SELECT job FROM main.document UNION SELECT job FROM main.frame);"
        "INSERT OR IGNORE INTO main.document (" STORE_SCHEMA_DOCUMENT_COLUMNS ", sum)"
        " SELECT " STORE_SCHEMA_DOCUMENT_COLUMNS ", sum FROM kept.document"
        " WHERE sum IS row_sum(" STORE_SCHEMA_DOCUMENT_COLUMNS ") AND job IN (SELECT id FROM main.job);"
        "DELETE FROM main.job WHERE sum IS NOT row_sum(" STORE_SCHEMA_JOB_COLUMNS ")"
        " AND id NOT IN (SELECT job FROM main.document);"
        "DELETE FROM main.document WHERE sum IS NOT row_sum(" STORE_SCHEMA_DOCUMENT_COLUMNS ")"
        " AND job NOT IN (SELECT id FROM main.job)";
    int before = sqlite3_total_changes(db);

    if (!store_sql_execute(db, sql, "restore jobs", error)) return false;
    if (sqlite3_total_changes(db) > before && *count == 0) {
        *count = sqlite3_total_changes(db) - before;
        log_error("store: queue.db lacked rows of jobs: %lld restored from the backup", (long long)*count);
    }
    return true;
}

static bool mend_all(sqlite3 *db, int64_t *count, struct error *error)
{
    bool ok = true;

    for (const struct store_table *table = store_tables; table->name && ok; table++) {
        ok = report(db, table, count, error);
        if (ok) ok = table->key ? mend_table(db, table, error) : mend_daemon(db, error);
    }
    if (*count > LINE_LIMIT) log_error("store: %lld damaged rows in all", (long long)*count);
    return ok && mend_lost(db, count, error);
}

// The key of a row as text: "job 7" is written "7", a frame "7 12".
static void on_concat_keys(sqlite3_context *context, int count, sqlite3_value **values)
{
    const char *first = (const char *)sqlite3_value_text(values[0]);
    const char *second = count > 1 ? (const char *)sqlite3_value_text(values[1]) : "";
    char *text = sqlite3_mprintf("%s%s%s", first ? first : "", count > 1 ? " " : "", second ? second : "");

    sqlite3_result_text(context, text, -1, sqlite3_free);
}

bool store_repair(sqlite3 *db, const char *folder, int64_t *count, struct error *error)
{
    int64_t damaged = 0;
    bool ok = false;

    if (count) *count = 0;
    if (!store_sum_count_damaged(db, STORE_SCHEMA_VERSION, &damaged, error)) return false;
    if (damaged == 0) return true;
    damaged = 0;
    sqlite3_create_function_v2(db, "concat_keys", -1, SQLITE_UTF8 | SQLITE_INNOCUOUS, NULL, on_concat_keys, NULL, NULL,
                               NULL);
    if (!attach_backup(db, folder, error)) return false;
    ok = store_sql_execute(db, "BEGIN IMMEDIATE", "begin to mend", error) && mend_all(db, &damaged, error) &&
         store_sql_execute(db, "COMMIT", "mend damaged rows", error);
    if (!ok && !sqlite3_get_autocommit(db)) sqlite3_exec(db, "ROLLBACK", NULL, NULL, NULL);
    sqlite3_exec(db, "DETACH kept", NULL, NULL, NULL);
    if (count) *count = damaged;
    return ok;
}
