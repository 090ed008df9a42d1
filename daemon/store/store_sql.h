// What the store's files share of SQLite: short calls, and its errors as sentences.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct sqlite3;
struct sqlite3_stmt;

// "store: cannot WHAT: CAUSE" from the connection's newest error.
void store_sql_set_error(struct error *error, struct sqlite3 *db, const char *what);

bool store_sql_execute(struct sqlite3 *db, const char *sql, const char *what, struct error *error);
// The first column of the first row, which must be there.
bool store_sql_read_integer(struct sqlite3 *db, const char *sql, int64_t *integer, struct error *error);
bool store_sql_prepare(struct sqlite3 *db, const char *sql, struct sqlite3_stmt **statement, struct error *error);
// Runs a statement that gives no rows and makes it ready for the next time.
bool store_sql_run(struct sqlite3_stmt *statement, const char *what, struct error *error);

void store_sql_bind_text(struct sqlite3_stmt *statement, int parameter, const char *text); // NULL or lent until it ran
char *store_sql_text(struct sqlite3_stmt *statement,
                     int column); // NULL, or lent until the next step; not to be changed
