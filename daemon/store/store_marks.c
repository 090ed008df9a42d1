// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_marks.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/job/frame_range.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sql.h"

#include <inttypes.h>
#include <sqlite3.h>
#include <string.h>

enum { BLOCK_BYTES = 2048, MARKS_OF_A_BYTE = 4, MARK_BITS = 2, MARK_OF_A_BYTE = 3 };

enum mark { MARK_NONE, MARK_FORCED, MARK_CANCELED, MARK_FAILED };

// SQLite writes no page whose rows are updated to what they were.
const char store_marks_set_sql[] = "INSERT INTO mark (job, block, marks, sum) VALUES (?1, ?2, ?3, row_sum(?1, ?2, ?3))"
                                   " ON CONFLICT DO UPDATE SET marks = ?3, sum = row_sum(?1, ?2, ?3)";
const char store_marks_drop_sql[] = "DELETE FROM mark WHERE job = ? AND block = ?";

// Done frames have rows, and what runs is queued after a restart.
static enum mark find_mark(const struct frame_states *states, int64_t index)
{
    switch (frame_states_get(states, index)) {
    case FRAME_CANCELED:
        return MARK_CANCELED;
    case FRAME_FAILED:
        return MARK_FAILED;
    case FRAME_QUEUED:
    case FRAME_RUNNING:
        return frame_states_is_forced(states, index) ? MARK_FORCED : MARK_NONE;
    default:
        return MARK_NONE;
    }
}

struct store_op store_marks_format_op(const struct queue_job *job)
{
    size_t size = ((size_t)job->states.frame_count + MARKS_OF_A_BYTE - 1) / MARKS_OF_A_BYTE;
    struct store_op op = {.kind = STORE_SET_MARKS, .marks = {.job = job->id, .size_bytes = size}};

    op.marks.bytes = xcalloc(size + 1, 1);
    for (int64_t i = 0; i < job->states.frame_count; i++)
        op.marks.bytes[i / MARKS_OF_A_BYTE] |=
            (uint8_t)(find_mark(&job->states, i) << (MARK_BITS * (i % MARKS_OF_A_BYTE)));
    return op;
}

static bool is_empty(const uint8_t *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++)
        if (bytes[i]) return false;
    return true;
}

bool store_marks_set(sqlite3_stmt *set, sqlite3_stmt *drop, const struct store_op *op, struct error *error)
{
    for (size_t first = 0; first < op->marks.size_bytes; first += BLOCK_BYTES) {
        const uint8_t *bytes = op->marks.bytes + first;
        size_t left = op->marks.size_bytes - first, size = left < BLOCK_BYTES ? left : BLOCK_BYTES;
        sqlite3_stmt *statement = is_empty(bytes, size) ? drop : set;

        sqlite3_bind_int64(statement, 1, op->marks.job);
        sqlite3_bind_int64(statement, 2, (int64_t)(first / BLOCK_BYTES));
        if (statement == set) sqlite3_bind_blob(statement, 3, bytes, (int)size, SQLITE_STATIC);
        if (!store_sql_run(statement, "mark frames", error)) return false;
    }
    return true;
}

static bool load_block(sqlite3_stmt *row, store_on_frame *on_frame, void *user, struct error *error)
{
    static const enum frame_state states[] = {
        [MARK_FORCED] = FRAME_QUEUED, [MARK_CANCELED] = FRAME_CANCELED, [MARK_FAILED] = FRAME_FAILED};
    int64_t job = sqlite3_column_int64(row, 0), first = sqlite3_column_int64(row, 1) * BLOCK_BYTES * MARKS_OF_A_BYTE;
    const uint8_t *bytes = sqlite3_column_blob(row, 2);
    int64_t count = (int64_t)sqlite3_column_bytes(row, 2) * MARKS_OF_A_BYTE;

    if (first < 0 || first + count > FRAME_COUNT_LIMIT + BLOCK_BYTES) {
        error_set(error, "store: job %" PRId64 " has marks of frames from index %" PRId64 " on, which is invalid", job,
                  first);
        return false;
    }
    for (int64_t i = 0; i < count; i++) {
        int mark = bytes[i / MARKS_OF_A_BYTE] >> (MARK_BITS * (i % MARKS_OF_A_BYTE)) & MARK_OF_A_BYTE;

        if (mark == MARK_NONE) continue;
        if (!on_frame(user,
                      &(struct store_frame){.job = job, .index = (int32_t)(first + i), .state = (int)states[mark]},
                      error))
            return false;
    }
    return true;
}

bool store_marks_load(sqlite3 *db, store_on_frame *on_frame, void *user, struct error *error)
{
    sqlite3_stmt *rows = NULL;
    bool ok = true;
    int result = SQLITE_DONE;

    if (!store_sql_prepare(db, "SELECT " STORE_SCHEMA_MARK_COLUMNS " FROM mark ORDER BY job, block", &rows, error))
        return false;
    while (ok && (result = sqlite3_step(rows)) == SQLITE_ROW)
        ok = load_block(rows, on_frame, user, error);
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, db, "load the marks of frames");
        ok = false;
    }
    sqlite3_finalize(rows);
    return ok;
}
