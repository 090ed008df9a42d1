// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_reader.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sql.h"
#include "daemon/store/store_sum.h"

#include <inttypes.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>

enum { BUSY_TIMEOUT_MS = 5000 };

struct store_reader {
    sqlite3 *db;                                                                      // owned
    sqlite3_stmt *frames, *attempts, *document, *plan, *plans, *farm, *roots, *usage; // owned
};

struct store_reader *store_reader_open(const char *folder, struct error *error)
{
    struct store_reader *reader = xcalloc(1, sizeof *reader);
    char *path = xasprintf("%s/queue.db", folder);
    bool ok = false;

    if (sqlite3_open_v2(path, &reader->db, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, NULL) != SQLITE_OK) {
        store_sql_set_error(error, reader->db, "open queue.db to read");
        goto out;
    }
    sqlite3_busy_timeout(reader->db, BUSY_TIMEOUT_MS);
    ok = store_sum_register(reader->db, error) &&
         store_sql_prepare(reader->db,
                           "SELECT " STORE_SCHEMA_FRAME_COLUMNS " FROM frame"
                           " WHERE job = ? AND frame_index BETWEEN ? AND ? ORDER BY frame_index",
                           &reader->frames, error) &&
         store_sql_prepare(reader->db,
                           "SELECT job, frame, attempt, worker, ended_ms, outcome, log FROM attempt"
                           " WHERE job = ?1 AND (?2 = -1 OR frame = ?2) ORDER BY number DESC LIMIT ?3",
                           &reader->attempts, error) &&
         store_sql_prepare(reader->db, "SELECT text, sum IS row_sum(job, text) FROM document WHERE job = ?",
                           &reader->document, error) &&
         store_sql_prepare(reader->db,
                           "SELECT number, text FROM plan WHERE owner_uid = ? AND scene = ? AND segment = ?"
                           " ORDER BY number DESC LIMIT 1",
                           &reader->plan, error) &&
         store_sql_prepare(
             reader->db, "SELECT number, text FROM plan WHERE owner_uid = ? AND scene = ? ORDER BY number DESC LIMIT ?",
             &reader->plans, error) &&
         store_sql_prepare(reader->db, "SELECT farm FROM daemon", &reader->farm, error) &&
         store_sql_prepare(reader->db, "SELECT path, id FROM root ORDER BY path", &reader->roots, error) &&
         store_sql_prepare(reader->db, "SELECT owner_uid, used_s, at_ms FROM usage ORDER BY owner_uid", &reader->usage,
                           error);
out:
    free(path);
    if (ok) return reader;
    store_reader_close(reader);
    return NULL;
}

void store_reader_close(struct store_reader *reader)
{
    if (!reader) return;
    sqlite3_finalize(reader->usage);
    sqlite3_finalize(reader->roots);
    sqlite3_finalize(reader->farm);
    sqlite3_finalize(reader->plan);
    sqlite3_finalize(reader->plans);
    sqlite3_finalize(reader->document);
    sqlite3_finalize(reader->attempts);
    sqlite3_finalize(reader->frames);
    sqlite3_close(reader->db);
    free(reader);
}

bool store_read_frames(struct store_reader *reader, int64_t job, int32_t first, int32_t last, store_on_frame *on_frame,
                       void *user, struct error *error)
{
    sqlite3_stmt *rows = reader->frames;
    bool ok = true;
    int result;

    sqlite3_bind_int64(rows, 1, job);
    sqlite3_bind_int(rows, 2, first);
    sqlite3_bind_int(rows, 3, last);
    while ((result = sqlite3_step(rows)) == SQLITE_ROW) {
        struct store_frame frame;

        ok = store_schema_read_frame(rows, &frame, error) && on_frame(user, &frame, error);
        if (!ok) break;
    }
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, reader->db, "read frames");
        ok = false;
    }
    sqlite3_reset(rows);
    return ok;
}

static void read_attempt(sqlite3_stmt *row, struct store_attempt *attempt)
{
    const char *outcome = store_sql_text(row, 5);

    *attempt = (struct store_attempt){.job = sqlite3_column_int64(row, 0),
                                      .frame = sqlite3_column_int(row, 1),
                                      .attempt = sqlite3_column_int(row, 2),
                                      .worker = sqlite3_column_int(row, 3),
                                      .ended_ms = sqlite3_column_int64(row, 4),
                                      .log = store_sql_text(row, 6)};
    snprintf(attempt->outcome, sizeof attempt->outcome, "%s", outcome ? outcome : "");
}

bool store_read_attempts(struct store_reader *reader, int64_t job, int32_t frame, int limit,
                         store_on_attempt *on_attempt, void *user, struct error *error)
{
    sqlite3_stmt *rows = reader->attempts;
    bool ok = true;
    int result;

    sqlite3_bind_int64(rows, 1, job);
    sqlite3_bind_int(rows, 2, frame);
    sqlite3_bind_int(rows, 3, limit > 0 ? limit : 0);
    while ((result = sqlite3_step(rows)) == SQLITE_ROW) {
        struct store_attempt attempt;

        read_attempt(rows, &attempt);
        ok = on_attempt(user, &attempt, error);
        if (!ok) break;
    }
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, reader->db, "read attempts");
        ok = false;
    }
    sqlite3_reset(rows);
    return ok;
}

bool store_read_document(struct store_reader *reader, int64_t job, char **document, struct error *error)
{
    sqlite3_stmt *rows = reader->document;
    int result;

    *document = NULL;
    sqlite3_bind_int64(rows, 1, job);
    result = sqlite3_step(rows);
    if (result == SQLITE_ROW && sqlite3_column_int(rows, 1) == 0) {
        error_set(error, "store: the document of job %" PRId64 " is damaged on the disk", job);
    } else if (result == SQLITE_ROW) {
        const char *text = store_sql_text(rows, 0);

        *document = xstrdup(text ? text : "");
    } else if (result == SQLITE_DONE) {
        error_set(error, "store: no job %" PRId64, job);
    } else {
        store_sql_set_error(error, reader->db, "read a job's file");
    }
    sqlite3_reset(rows);
    return *document != NULL;
}

bool store_read_plan(struct store_reader *reader, const struct plan_key *key, int64_t *number, char **text,
                     struct error *error)
{
    sqlite3_stmt *rows = reader->plan;
    int result;

    *number = 0;
    *text = NULL;
    sqlite3_bind_int64(rows, 1, key->owner_uid);
    store_sql_bind_text(rows, 2, key->scene);
    store_sql_bind_text(rows, 3, key->segment);
    result = sqlite3_step(rows);
    if (result == SQLITE_ROW) {
        const char *found = store_sql_text(rows, 1);

        *number = sqlite3_column_int64(rows, 0);
        *text = xstrdup(found ? found : "");
    } else if (result != SQLITE_DONE) {
        store_sql_set_error(error, reader->db, "read a plan");
    }
    sqlite3_reset(rows);
    return result == SQLITE_ROW || result == SQLITE_DONE;
}

bool store_read_plans(struct store_reader *reader, int64_t owner_uid, const char *scene, int limit,
                      store_on_plan *on_plan, void *user, struct error *error)
{
    sqlite3_stmt *rows = reader->plans;
    bool ok = true;
    int result;

    sqlite3_bind_int64(rows, 1, owner_uid);
    store_sql_bind_text(rows, 2, scene);
    sqlite3_bind_int(rows, 3, limit);
    while (ok && (result = sqlite3_step(rows)) != SQLITE_DONE) {
        const char *text = result == SQLITE_ROW ? store_sql_text(rows, 1) : NULL;

        ok = result == SQLITE_ROW;
        if (!ok)
            store_sql_set_error(error, reader->db, "read the plans");
        else
            ok = on_plan(user, sqlite3_column_int64(rows, 0), text ? text : "", error);
    }
    sqlite3_reset(rows);
    return ok;
}

bool store_read_farm(struct store_reader *reader, char farm[static ROOT_MARKER_ID_SIZE], struct error *error)
{
    const char *text = NULL;
    int result = sqlite3_step(reader->farm);

    if (result == SQLITE_ROW) text = store_sql_text(reader->farm, 0);
    snprintf(farm, ROOT_MARKER_ID_SIZE, "%s", text ? text : "");
    if (result != SQLITE_ROW)
        store_sql_set_error(error, reader->db, "read the farm's id");
    else if (!root_marker_is_id(farm))
        error_set(error, "store: the farm's id is \"%s\", expected 32 hexadecimal digits", farm);
    sqlite3_reset(reader->farm);
    return root_marker_is_id(farm);
}

bool store_read_roots(struct store_reader *reader, store_on_root *on_root, void *user, struct error *error)
{
    sqlite3_stmt *rows = reader->roots;
    bool ok = true;
    int result;

    while ((result = sqlite3_step(rows)) == SQLITE_ROW) {
        const struct store_root root = {.path = store_sql_text(rows, 0), .id = store_sql_text(rows, 1)};

        ok = on_root(user, &root, error);
        if (!ok) break;
    }
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, reader->db, "read the output roots");
        ok = false;
    }
    sqlite3_reset(rows);
    return ok;
}

bool store_read_usage(struct store_reader *reader, store_on_usage *on_usage, void *user, struct error *error)
{
    sqlite3_stmt *rows = reader->usage;
    bool ok = true;
    int result;

    while ((result = sqlite3_step(rows)) == SQLITE_ROW) {
        const struct store_usage usage = {.owner_uid = sqlite3_column_int64(rows, 0),
                                          .used_s = sqlite3_column_double(rows, 1),
                                          .at_ms = sqlite3_column_int64(rows, 2)};

        ok = on_usage(user, &usage, error);
        if (!ok) break;
    }
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, reader->db, "read what owners used");
        ok = false;
    }
    sqlite3_reset(rows);
    return ok;
}

bool store_read_tokens(struct store_reader *reader, store_on_token *on_token, void *user, int64_t *last_id,
                       struct error *error)
{
    return store_tokens_read(reader->db, on_token, user, last_id, error);
}

bool store_read_notices(struct store_reader *reader, int64_t after, int limit, store_on_notice *on_notice, void *user,
                        struct error *error)
{
    return store_notices_read(reader->db, after, limit, on_notice, user, error);
}

bool store_list_notices(struct store_reader *reader, store_on_notice *on_notice, void *user, struct error *error)
{
    return store_notices_list(reader->db, on_notice, user, error);
}

bool store_read_told(struct store_reader *reader, store_on_told *on_told, void *user, struct error *error)
{
    return store_notices_read_told(reader->db, on_told, user, error);
}
