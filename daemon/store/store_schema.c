// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_schema.h"

#include "core/base/error.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/store_op.h"
#include "daemon/store/store_sql.h"

#include <inttypes.h>
#include <sqlite3.h>
#include <stdio.h>

enum { NO_VERSION = 0, FIRST_VERSION = 1 };

#define APPLICATION_ID 1299342184 // "Mrch": identifies the database as a store
#define STRINGIFY(number) #number
#define TEXT_OF(number) STRINGIFY(number)

// The tables of the first version. Each later version is made from the one before it, by one step.
static const char first_sql[] =
    "CREATE TABLE daemon (epoch INTEGER NOT NULL);"
    "INSERT INTO daemon VALUES (0);"
    "CREATE TABLE job ("
    "    id INTEGER PRIMARY KEY, name TEXT, owner TEXT, owner_uid INTEGER NOT NULL, priority INTEGER NOT NULL,"
    "    is_paused INTEGER NOT NULL, is_canceled INTEGER NOT NULL, is_failed INTEGER NOT NULL,"
    "    submitted_ms INTEGER NOT NULL, started_ms INTEGER NOT NULL, finished_ms INTEGER NOT NULL,"
    "    reason TEXT, root TEXT);"
    // A table apart from `job`, whose rows are rewritten whole at every change.
    "CREATE TABLE document (job INTEGER PRIMARY KEY, text TEXT NOT NULL);"
    "CREATE TABLE frame ("
    "    job INTEGER NOT NULL, frame_index INTEGER NOT NULL, state INTEGER NOT NULL,"
    "    attempts INTEGER NOT NULL DEFAULT 0, epoch INTEGER NOT NULL DEFAULT 0, inode INTEGER NOT NULL DEFAULT 0,"
    "    size_bytes INTEGER NOT NULL DEFAULT 0, hash TEXT, render_s REAL NOT NULL DEFAULT 0,"
    "    encode_s REAL NOT NULL DEFAULT 0, error TEXT, PRIMARY KEY (job, frame_index)) WITHOUT ROWID;"
    "CREATE TABLE attempt ("
    "    job INTEGER NOT NULL, number INTEGER NOT NULL, frame INTEGER NOT NULL, attempt INTEGER NOT NULL,"
    "    worker INTEGER NOT NULL, ended_ms INTEGER NOT NULL, outcome TEXT NOT NULL, log TEXT,"
    "    PRIMARY KEY (job, number)) WITHOUT ROWID;"
    "PRAGMA application_id = " TEXT_OF(APPLICATION_ID);

// steps[N] upgrades version N to N + 1. Columns that a step adds are NULL in existing rows.
static const char *const steps[STORE_SCHEMA_VERSION] = {
    [NO_VERSION] = first_sql,
    [1] = "ALTER TABLE frame ADD COLUMN audit TEXT;"
          "ALTER TABLE frame ADD COLUMN measured_error REAL;"
          "ALTER TABLE frame ADD COLUMN error95 REAL;"
          "ALTER TABLE frame ADD COLUMN audit_rays INTEGER;"
          "ALTER TABLE frame ADD COLUMN method TEXT;"
          "ALTER TABLE frame ADD COLUMN cut_share REAL;",
    // The highest id of deleted jobs; other ids are in `job`.
    [2] = "ALTER TABLE daemon ADD COLUMN last_job_id INTEGER NOT NULL DEFAULT 0;",
    [3] = "CREATE TABLE plan ("
          "    number INTEGER PRIMARY KEY, owner_uid INTEGER NOT NULL, scene TEXT NOT NULL, segment TEXT NOT NULL,"
          "    text TEXT NOT NULL);"
          "CREATE INDEX plan_of_owner ON plan (owner_uid);"
          "CREATE INDEX plan_of_segment ON plan (owner_uid, scene, segment);"
          "ALTER TABLE frame ADD COLUMN plan INTEGER;",
    [4] = "ALTER TABLE frame ADD COLUMN traced REAL;",
    // The farm's id, and the ids of the output roots that it has used.
    [5] = "ALTER TABLE daemon ADD COLUMN farm TEXT;"
          "UPDATE daemon SET farm = lower(hex(randomblob(16)));"
          "CREATE TABLE root (path TEXT PRIMARY KEY, id TEXT NOT NULL) WITHOUT ROWID;",
    [6] = "CREATE TABLE usage (owner_uid INTEGER PRIMARY KEY, used_s REAL NOT NULL, at_ms INTEGER NOT NULL);",
    [7] = "ALTER TABLE frame ADD COLUMN audit_s REAL;",
    // The sums of rows, which are filled when all steps are done.
    [8] = "ALTER TABLE daemon ADD COLUMN sum INTEGER; ALTER TABLE job ADD COLUMN sum INTEGER;"
          "ALTER TABLE document ADD COLUMN sum INTEGER; ALTER TABLE frame ADD COLUMN sum INTEGER;"
          "ALTER TABLE attempt ADD COLUMN sum INTEGER; ALTER TABLE plan ADD COLUMN sum INTEGER;"
          "ALTER TABLE root ADD COLUMN sum INTEGER; ALTER TABLE usage ADD COLUMN sum INTEGER;",
    // Before, each marked frame had a row: one that is queued, canceled or failed, and says nothing else.
    [9] = "CREATE TABLE mark (job INTEGER NOT NULL, block INTEGER NOT NULL, marks BLOB NOT NULL, sum INTEGER,"
          " PRIMARY KEY (job, block)) WITHOUT ROWID;",
    // AUTOINCREMENT: who revokes a token by its id never revokes a later one.
    [10] = "CREATE TABLE token ("
           "    id INTEGER PRIMARY KEY AUTOINCREMENT, hash TEXT NOT NULL, name TEXT NOT NULL, owner TEXT NOT NULL,"
           "    owner_uid INTEGER NOT NULL, scope TEXT NOT NULL, created_ms INTEGER NOT NULL,"
           "    expires_ms INTEGER NOT NULL, used_ms INTEGER NOT NULL, is_once INTEGER NOT NULL, sum INTEGER);",
    [11] = "CREATE TABLE notice (id INTEGER PRIMARY KEY, job INTEGER NOT NULL, owner_uid INTEGER NOT NULL,"
           " made_ms INTEGER NOT NULL, event TEXT NOT NULL, target TEXT NOT NULL, is_webhook INTEGER NOT NULL,"
           " body TEXT NOT NULL, sum INTEGER);"
           "CREATE TABLE told (job INTEGER NOT NULL, cause INTEGER NOT NULL, told_ms INTEGER NOT NULL,"
           " is_on INTEGER NOT NULL, sum INTEGER, PRIMARY KEY (job, cause)) WITHOUT ROWID;",
    // 1 where the job comes after others that are not over; else NULL.
    [12] = "ALTER TABLE job ADD COLUMN waits INTEGER;",
};

#define FILL(table, columns) "UPDATE " table " SET sum = row_sum(" columns ");"

static const char sums_sql[] = FILL("daemon", STORE_SCHEMA_DAEMON_COLUMNS) FILL("job", STORE_SCHEMA_JOB_COLUMNS)
    FILL("document", STORE_SCHEMA_DOCUMENT_COLUMNS) FILL("frame", STORE_SCHEMA_FRAME_COLUMNS)
        FILL("attempt", STORE_SCHEMA_ATTEMPT_COLUMNS) FILL("plan", STORE_SCHEMA_PLAN_COLUMNS)
            FILL("root", STORE_SCHEMA_ROOT_COLUMNS) FILL("usage", STORE_SCHEMA_USAGE_COLUMNS);

bool store_schema_check(sqlite3 *db, int *found, struct error *error)
{
    int64_t application, version, tables;

    if (!store_sql_read_integer(db, "PRAGMA application_id", &application, error)) return false;
    if (!store_sql_read_integer(db, "PRAGMA user_version", &version, error)) return false;
    if (!store_sql_read_integer(db, "SELECT count(*) FROM sqlite_schema", &tables, error)) return false;

    *found = NO_VERSION;
    if (application == 0 && version == 0 && tables == 0) return true;
    if (application != APPLICATION_ID) {
        error_set(error, "store: queue.db is a database of another program, expected marchd's");
        return false;
    }
    if (version > STORE_SCHEMA_VERSION) {
        error_set(error,
                  "store: written by a newer marchd (version %" PRId64
                  ", this one reads %d): install that one again, or "
                  "restore a copy from before the upgrade (march restore FILE)",
                  version, STORE_SCHEMA_VERSION);
        return false;
    }
    if (version < FIRST_VERSION) {
        error_set(error, "store: version %" PRId64 ", expected %d to %d", version, FIRST_VERSION, STORE_SCHEMA_VERSION);
        return false;
    }
    *found = (int)version;
    return true;
}

bool store_schema_upgrade(sqlite3 *db, int found, struct error *error)
{
    if (found == STORE_SCHEMA_VERSION) return true;
    for (int version = found; version < STORE_SCHEMA_VERSION; version++)
        if (!store_sql_execute(db, steps[version], "make the tables", error)) return false;
    if (found < STORE_SCHEMA_FIRST_WITH_SUMS && !store_sql_execute(db, sums_sql, "make the sums of rows", error))
        return false;
    return store_sql_execute(db, "PRAGMA user_version = " TEXT_OF(STORE_SCHEMA_VERSION), "make the tables", error);
}

bool store_schema_read_state(sqlite3_stmt *row, struct store_frame *frame, struct error *error)
{
    int64_t index = sqlite3_column_int64(row, 1);

    *frame = (struct store_frame){.job = sqlite3_column_int64(row, 0),
                                  .index = (int32_t)index,
                                  .state = sqlite3_column_int(row, 2),
                                  .attempts = sqlite3_column_int(row, 3)};
    if (index >= 0 && index < FRAME_COUNT_LIMIT && frame->state >= 0 && frame->state < FRAME_STATE_COUNT) return true;
    error_set(error, "store: job %" PRId64 " has a frame of index %" PRId64 " in state %d, which is invalid",
              frame->job, index, frame->state);
    return false;
}

static void read_name(sqlite3_stmt *row, int column, char name[static FRAME_ACCURACY_TEXT_SIZE])
{
    const char *text = store_sql_text(row, column);

    if (text) snprintf(name, FRAME_ACCURACY_TEXT_SIZE, "%s", text);
}

void store_schema_read_error(sqlite3_stmt *row, int column, struct frame_accuracy *accuracy)
{
    read_name(row, column, accuracy->audit);
    accuracy->error = sqlite3_column_double(row, column + 1);
    accuracy->error95 = sqlite3_column_double(row, column + 2);
    accuracy->audit_rays = sqlite3_column_int(row, column + 3);
    read_name(row, column + 4, accuracy->method);
}

static void read_accuracy(sqlite3_stmt *row, struct frame_accuracy *accuracy)
{
    store_schema_read_error(row, 11, accuracy);
    accuracy->has_cut_share = sqlite3_column_type(row, 16) != SQLITE_NULL;
    accuracy->cut_share = sqlite3_column_double(row, 16);
    accuracy->plan = sqlite3_column_int64(row, 17);
    accuracy->traced = sqlite3_column_double(row, 18);
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
    frame->audit_s = sqlite3_column_double(row, 19);
    read_accuracy(row, &frame->accuracy);
    return true;
}
