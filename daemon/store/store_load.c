// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_load.h"

#include "core/base/error.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/store_marks.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sql.h"

#include <inttypes.h>
#include <sqlite3.h>

static const char jobs_sql[] =
    "SELECT " STORE_SCHEMA_JOB_COLUMNS ", text, job.sum IS row_sum(" STORE_SCHEMA_JOB_COLUMNS "),"
    " document.sum IS row_sum(" STORE_SCHEMA_DOCUMENT_COLUMNS ")"
    " FROM job LEFT JOIN document ON document.job = id ORDER BY id";
static const char frames_sql[] =
    "SELECT job, frame_index, state, attempts, size_bytes, audit, measured_error, error95, audit_rays, method,"
    " render_s, audit_s"
    " FROM frame ORDER BY job, frame_index";
static const char frame_sql[] = "SELECT " STORE_SCHEMA_FRAME_COLUMNS " FROM frame WHERE job = ? AND frame_index = ?";

static bool read_job(sqlite3_stmt *row, struct store_job *job, struct error *error)
{
    *job = (struct store_job){.id = sqlite3_column_int64(row, 0),
                              .priority = sqlite3_column_int(row, 1),
                              .is_paused = sqlite3_column_int(row, 2) != 0,
                              .is_canceled = sqlite3_column_int(row, 3) != 0,
                              .is_failed = sqlite3_column_int(row, 4) != 0,
                              .submitted_ms = sqlite3_column_int64(row, 5),
                              .started_ms = sqlite3_column_int64(row, 6),
                              .finished_ms = sqlite3_column_int64(row, 7),
                              .reason = store_sql_text(row, 8),
                              .name = store_sql_text(row, 9),
                              .owner = store_sql_text(row, 10),
                              .owner_uid = sqlite3_column_int64(row, 11),
                              .root = store_sql_text(row, 12),
                              .waits = sqlite3_column_int(row, 13) != 0,
                              .document = store_sql_text(row, 14),
                              .is_damaged = sqlite3_column_int(row, 15) == 0,
                              .is_document_damaged = sqlite3_column_int(row, 16) == 0};
    if (job->is_damaged && (job->priority < 0 || job->priority >= QUEUE_PRIORITY_LIMIT)) job->priority = 0;
    if (job->id > 0 && job->priority >= 0 && job->priority < QUEUE_PRIORITY_LIMIT &&
        (job->document || job->is_document_damaged))
        return true;
    error_set(error, "store: job %" PRId64 " has priority %d, expected 0 to %d", job->id, job->priority,
              QUEUE_PRIORITY_LIMIT - 1);
    return false;
}

static bool load_jobs(sqlite3 *db, store_on_job *on_job, void *user, struct error *error)
{
    sqlite3_stmt *rows = NULL;
    bool ok = true;
    int result;

    if (!store_sql_prepare(db, jobs_sql, &rows, error)) return false;
    while ((result = sqlite3_step(rows)) == SQLITE_ROW) {
        struct store_job job;

        ok = read_job(rows, &job, error) && on_job(user, &job, error);
        if (!ok) break;
    }
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, db, "load the jobs");
        ok = false;
    }
    sqlite3_finalize(rows);
    return ok;
}

// A frame that was being published needs its whole row.
static bool load_intent(sqlite3_stmt *row, int64_t job, int32_t index, store_on_frame *on_frame, void *user,
                        struct error *error)
{
    struct store_frame frame;
    bool ok = false;

    sqlite3_bind_int64(row, 1, job);
    sqlite3_bind_int(row, 2, index);
    if (sqlite3_step(row) != SQLITE_ROW)
        store_sql_set_error(error, sqlite3_db_handle(row), "load a frame");
    else
        ok = store_schema_read_frame(row, &frame, error) && on_frame(user, &frame, error);
    sqlite3_reset(row);
    return ok;
}

static bool load_frames(sqlite3 *db, store_on_frame *on_frame, void *user, struct error *error)
{
    sqlite3_stmt *rows = NULL, *intent = NULL;
    bool ok = true;
    int result;

    if (!store_sql_prepare(db, frames_sql, &rows, error)) return false;
    if (!store_sql_prepare(db, frame_sql, &intent, error)) {
        sqlite3_finalize(rows);
        return false;
    }
    while ((result = sqlite3_step(rows)) == SQLITE_ROW) {
        struct store_frame frame;

        ok = store_schema_read_state(rows, &frame, error);
        frame.size_bytes = (uint64_t)sqlite3_column_int64(rows, 4);
        store_schema_read_error(rows, 5, &frame.accuracy);
        frame.render_s = sqlite3_column_double(rows, 10);
        frame.audit_s = sqlite3_column_double(rows, 11);
        if (ok && frame.state == FRAME_RUNNING)
            ok = load_intent(intent, frame.job, frame.index, on_frame, user, error);
        else if (ok)
            ok = on_frame(user, &frame, error);
        if (!ok) break;
    }
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, db, "load the frames");
        ok = false;
    }
    sqlite3_finalize(intent);
    sqlite3_finalize(rows);
    return ok;
}

bool store_load_rows(sqlite3 *db, store_on_job *on_job, store_on_frame *on_frame, void *user, struct error *error)
{
    return load_jobs(db, on_job, user, error) && store_marks_load(db, on_frame, user, error) &&
           load_frames(db, on_frame, user, error);
}
