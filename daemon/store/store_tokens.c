// SPDX-License-Identifier: Apache-2.0
#include "daemon/store/store_tokens.h"

#include "core/base/error.h"
#include "daemon/store/store_schema.h"
#include "daemon/store/store_sql.h"

#include <inttypes.h>
#include <sqlite3.h>

static const char set_sql[] = "REPLACE INTO token (" STORE_SCHEMA_TOKEN_COLUMNS ", sum)"
                              " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10,"
                              " row_sum(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10))";

bool store_tokens_set(sqlite3 *db, const struct store_token *token, struct error *error)
{
    sqlite3_stmt *set = NULL;
    bool ok = store_sql_prepare(db, set_sql, &set, error);

    if (ok) {
        sqlite3_bind_int64(set, 1, token->id);
        store_sql_bind_text(set, 2, token->hash);
        store_sql_bind_text(set, 3, token->name);
        store_sql_bind_text(set, 4, token->owner);
        sqlite3_bind_int64(set, 5, token->owner_uid);
        store_sql_bind_text(set, 6, token->scope);
        sqlite3_bind_int64(set, 7, token->created_ms);
        sqlite3_bind_int64(set, 8, token->expires_ms);
        sqlite3_bind_int64(set, 9, token->used_ms);
        sqlite3_bind_int(set, 10, token->is_once);
        ok = store_sql_run(set, "write a token", error);
    }
    sqlite3_finalize(set);
    return ok;
}

bool store_tokens_delete(sqlite3 *db, int64_t id, struct error *error)
{
    sqlite3_stmt *drop = NULL;
    bool ok = store_sql_prepare(db, "DELETE FROM token WHERE id = ?", &drop, error);

    if (ok) {
        sqlite3_bind_int64(drop, 1, id);
        ok = store_sql_run(drop, "delete a token", error);
    }
    sqlite3_finalize(drop);
    return ok;
}

static struct store_token read_row(sqlite3_stmt *row)
{
    return (struct store_token){.id = sqlite3_column_int64(row, 0),
                                .hash = store_sql_text(row, 1),
                                .name = store_sql_text(row, 2),
                                .owner = store_sql_text(row, 3),
                                .owner_uid = sqlite3_column_int64(row, 4),
                                .scope = store_sql_text(row, 5),
                                .created_ms = sqlite3_column_int64(row, 6),
                                .expires_ms = sqlite3_column_int64(row, 7),
                                .used_ms = sqlite3_column_int64(row, 8),
                                .is_once = sqlite3_column_int(row, 9) != 0};
}

bool store_tokens_read(sqlite3 *db, store_on_token *on_token, void *user, int64_t *last_id, struct error *error)
{
    sqlite3_stmt *rows = NULL;
    bool ok = store_sql_read_integer(db, "SELECT coalesce((SELECT seq FROM sqlite_sequence WHERE name = 'token'), 0)",
                                     last_id, error) &&
              store_sql_prepare(db,
                                "SELECT " STORE_SCHEMA_TOKEN_COLUMNS
                                " FROM token WHERE sum IS row_sum(" STORE_SCHEMA_TOKEN_COLUMNS ") ORDER BY id",
                                &rows, error);
    int result = SQLITE_DONE;

    while (ok && (result = sqlite3_step(rows)) == SQLITE_ROW) {
        const struct store_token token = read_row(rows);

        if (token.hash && token.name && token.owner && token.scope) {
            ok = on_token(user, &token, error);
        } else {
            error_set(error, "store: token %" PRId64 " has no hash, name, owner or scope", token.id);
            ok = false;
        }
    }
    if (ok && result != SQLITE_DONE) {
        store_sql_set_error(error, db, "read the tokens");
        ok = false;
    }
    sqlite3_finalize(rows);
    return ok;
}

bool store_tokens_forget(const char *path, struct error *error)
{
    sqlite3 *db = NULL;
    int version = 0;
    bool ok = false;

    if (sqlite3_open_v2(path, &db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, NULL) != SQLITE_OK)
        store_sql_set_error(error, db, "open the copy");
    else
        ok = store_schema_check(db, &version, error) &&
             (version < STORE_SCHEMA_FIRST_WITH_TOKENS ||
              store_sql_execute(db, "DELETE FROM token", "forget the tokens", error));
    sqlite3_close(db);
    return ok;
}
