// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_sum.h"

#include "core/base/alloc.h"
#include "core/base/hash.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sql.h"

#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

const struct store_table store_tables[] = {
    {"daemon", STORE_SCHEMA_DAEMON_COLUMNS, NULL, false, 9, "ids and epochs go on far above the last known"},
    {"job", STORE_SCHEMA_JOB_COLUMNS, "id", false, 9, "the job is held"},
    {"document", STORE_SCHEMA_DOCUMENT_COLUMNS, "job", false, 9, "the job fails"},
    {"frame", STORE_SCHEMA_FRAME_COLUMNS, "job, frame_index", true, 9, "the frame is looked at again"},
    {"mark", STORE_SCHEMA_MARK_COLUMNS, "job, block", true, 10, "its canceled frames are queued again"},
    {"attempt", STORE_SCHEMA_ATTEMPT_COLUMNS, "job, number", true, 9, "the attempt's message is lost"},
    {"plan", STORE_SCHEMA_PLAN_COLUMNS, "number", true, 9, "the plan is made again"},
    {"root", STORE_SCHEMA_ROOT_COLUMNS, "path", true, 9, "the root is known by its marker"},
    {"usage", STORE_SCHEMA_USAGE_COLUMNS, "owner_uid", true, 9, "the owner's use of the farm begins anew"},
    {"token", STORE_SCHEMA_TOKEN_COLUMNS, "id", true, STORE_SCHEMA_FIRST_WITH_TOKENS, "the token is no longer one"},
    {"notice", STORE_SCHEMA_NOTICE_COLUMNS, "id", true, STORE_SCHEMA_FIRST_WITH_NOTICES, "its target is not told"},
    {"told", STORE_SCHEMA_TOLD_COLUMNS, "job, cause", true, STORE_SCHEMA_FIRST_WITH_NOTICES,
     "the job may tell it again"},
    {0}};

static const char lost_sql[] = "SELECT (SELECT count(*) FROM document WHERE job NOT IN (SELECT id FROM job))"
                               " + (SELECT count(*) FROM job WHERE id NOT IN (SELECT job FROM document))";

// A NULL adds nothing, so that a column that a later version adds leaves the sums of older rows as they are.
static void on_row_sum(sqlite3_context *context, int count, sqlite3_value **values)
{
    uint64_t sum = 0;

    for (int i = 0; i < count; i++) {
        int type = sqlite3_value_type(values[i]);
        uint64_t seed = sum * 31 + (uint64_t)i * 8 + (uint64_t)type;
        int64_t integer = sqlite3_value_int64(values[i]);
        double real;

        if (type == SQLITE_INTEGER) {
            sum = hash_bytes_short(&integer, sizeof integer, seed);
        } else if (type == SQLITE_FLOAT) {
            real = sqlite3_value_double(values[i]) + 0.0; // SQLite stores -0.0 as 0
            sum = hash_bytes_short(&real, sizeof real, seed);
        } else if (type != SQLITE_NULL) {
            const void *bytes = sqlite3_value_blob(values[i]);

            sum = hash_bytes_short(bytes, (size_t)sqlite3_value_bytes(values[i]), seed);
        }
    }
    sqlite3_result_int64(context, (int64_t)sum);
}

bool store_sum_register(sqlite3 *db, struct error *error)
{
    int flags = SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_INNOCUOUS;

    if (sqlite3_create_function_v2(db, "row_sum", -1, flags, NULL, on_row_sum, NULL, NULL, NULL) == SQLITE_OK)
        return true;
    store_sql_set_error(error, db, "define the sum of rows");
    return false;
}

// The table of jobs has got a column since it has sums.
static const char *columns_of(const struct store_table *table, int version)
{
    bool is_first = strcmp(table->name, "job") == 0 && version < STORE_SCHEMA_FIRST_WITH_WAITS;

    return is_first ? STORE_SCHEMA_JOB_FIRST_COLUMNS : table->columns;
}

bool store_sum_count_damaged(sqlite3 *db, int version, int64_t *count, struct error *error)
{
    bool ok;

    *count = 0;
    if (version < STORE_SCHEMA_FIRST_WITH_SUMS) return true;
    ok = store_sql_read_integer(db, lost_sql, count, error);
    for (const struct store_table *table = store_tables; table->name && ok; table++) {
        char *sql;
        int64_t damaged = 0;

        if (table->first_version > version) continue;
        sql =
            xasprintf("SELECT count(*) FROM %s WHERE sum IS NOT row_sum(%s)", table->name, columns_of(table, version));
        ok = store_sql_read_integer(db, sql, &damaged, error);
        *count += damaged;
        free(sql);
    }
    return ok;
}
