// Short calls of SQLite for the store, with its errors as sentences.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct sqlite3;
struct sqlite3_stmt;

bool store_sql_is_readable(
    struct sqlite3 *db);                    // false: what the latest error says, or a look at all pages finds damage
bool store_sql_is_full(struct sqlite3 *db); // the connection's latest error is a full disk

// Sets "store: cannot WHAT: CAUSE", with the cause of the connection's latest error.
void store_sql_set_error(struct error *error, struct sqlite3 *db, const char *what);

bool store_sql_execute(struct sqlite3 *db, const char *sql, const char *what, struct error *error);
// Reads the first column of the first row, which must exist.
bool store_sql_read_integer(struct sqlite3 *db, const char *sql, int64_t *integer, struct error *error);
bool store_sql_prepare(struct sqlite3 *db, const char *sql, struct sqlite3_stmt **statement, struct error *error);
// Runs a statement that returns no rows and resets it.
bool store_sql_run(struct sqlite3_stmt *statement, const char *what, struct error *error);

// `text` may be NULL; borrowed until the statement ran.
void store_sql_bind_text(struct sqlite3_stmt *statement, int parameter, const char *text);
char *store_sql_text(struct sqlite3_stmt *statement, int column); // NULL, or borrowed until the next step; read only
