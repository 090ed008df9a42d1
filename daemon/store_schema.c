#include "daemon/store_schema.h"

#include "core/error.h"
#include "daemon/store.h"
#include "daemon/store_sql.h"

#include <inttypes.h>
#include <sqlite3.h>
#include <stdio.h>

#define APPLICATION_ID 1299342184 // "Mrch": tells the database from any other program's
#define STRINGIFY(number) #number
#define TEXT_OF(number) STRINGIFY(number)

static const char create_sql[] = "PRAGMA application_id = " TEXT_OF(
    APPLICATION_ID) ";"
                    "PRAGMA user_version = " TEXT_OF(
                        STORE_SCHEMA_VERSION) ";"
                                              "CREATE TABLE daemon (epoch INTEGER NOT NULL);"
                                              "INSERT INTO daemon VALUES (0);"
                                              "CREATE TABLE job ("
                                              "    id INTEGER PRIMARY KEY, name TEXT, owner TEXT, owner_uid INTEGER "
                                              "NOT NULL, priority INTEGER NOT NULL,"
                                              "    is_paused INTEGER NOT NULL, is_canceled INTEGER NOT NULL, is_failed "
                                              "INTEGER NOT NULL,"
                                              "    submitted_ms INTEGER NOT NULL, started_ms INTEGER NOT NULL, "
                                              "finished_ms INTEGER NOT NULL,"
                                              "    reason TEXT, root TEXT);"
                                              // Apart from `job`, whose rows are rewritten whole at every change.
                                              "CREATE TABLE document (job INTEGER PRIMARY KEY, text TEXT NOT NULL);"
                                              "CREATE TABLE frame ("
                                              "    job INTEGER NOT NULL, frame_index INTEGER NOT NULL, state INTEGER "
                                              "NOT NULL,"
                                              "    attempts INTEGER NOT NULL DEFAULT 0, epoch INTEGER NOT NULL DEFAULT "
                                              "0, inode INTEGER NOT NULL DEFAULT 0,"
                                              "    size_bytes INTEGER NOT NULL DEFAULT 0, hash TEXT, render_s REAL NOT "
                                              "NULL DEFAULT 0,"
                                              "    encode_s REAL NOT NULL DEFAULT 0, error TEXT, PRIMARY KEY (job, "
                                              "frame_index)) WITHOUT ROWID;"
                                              "CREATE TABLE attempt ("
                                              "    job INTEGER NOT NULL, number INTEGER NOT NULL, frame INTEGER NOT "
                                              "NULL, attempt INTEGER NOT NULL,"
                                              "    worker INTEGER NOT NULL, ended_ms INTEGER NOT NULL, outcome TEXT "
                                              "NOT NULL, log TEXT,"
                                              "    PRIMARY KEY (job, number)) WITHOUT ROWID;";

bool store_schema_check(sqlite3 *db, bool *is_new, struct error *error)
{
    int64_t application, version, tables;

    if (!store_sql_read_integer(db, "PRAGMA application_id", &application, error)) return false;
    if (!store_sql_read_integer(db, "PRAGMA user_version", &version, error)) return false;
    if (!store_sql_read_integer(db, "SELECT count(*) FROM sqlite_schema", &tables, error)) return false;

    *is_new = application == 0 && version == 0 && tables == 0;
    if (*is_new) return true;
    if (application != APPLICATION_ID) {
        error_set(error, "store: queue.db is a database of another program, expected marchd's");
        return false;
    }
    if (version > STORE_SCHEMA_VERSION) {
        error_set(error, "store: written by a newer marchd (version %" PRId64 ", this one reads %d)", version,
                  STORE_SCHEMA_VERSION);
        return false;
    }
    if (version < STORE_SCHEMA_VERSION) {
        error_set(error, "store: version %" PRId64 ", expected %d", version, STORE_SCHEMA_VERSION);
        return false;
    }
    return true;
}

bool store_schema_create(sqlite3 *db, struct error *error)
{
    return store_sql_execute(db, create_sql, "make the tables", error);
}

bool store_schema_read_state(sqlite3_stmt *row, struct store_frame *frame, struct error *error)
{
    int64_t index = sqlite3_column_int64(row, 1);

    *frame = (struct store_frame){.job = sqlite3_column_int64(row, 0),
                                  .index = (int32_t)index,
                                  .state = sqlite3_column_int(row, 2),
                                  .attempts = sqlite3_column_int(row, 3)};
    if (index >= 0 && index < FRAME_COUNT_LIMIT && frame->state >= 0 && frame->state < FRAME_STATE_COUNT) return true;
    error_set(error, "store: job %" PRId64 " has a frame of index %" PRId64 " in state %d, which cannot be", frame->job,
              index, frame->state);
    return false;
}

bool store_schema_read_frame(sqlite3_stmt *row, struct store_frame *frame, struct error *error)
{
    const char *hash;

    if (!store_schema_read_state(row, frame, error)) return false;
    frame->epoch = sqlite3_column_int64(row, 4);
    frame->inode = (uint64_t)sqlite3_column_int64(row, 5);
    frame->size_bytes = (uint64_t)sqlite3_column_int64(row, 6);
    hash = store_sql_text(row, 7);
    if (hash) snprintf(frame->hash, sizeof frame->hash, "%s", hash);
    frame->render_s = sqlite3_column_double(row, 8);
    frame->encode_s = sqlite3_column_double(row, 9);
    frame->error = store_sql_text(row, 10);
    return true;
}
