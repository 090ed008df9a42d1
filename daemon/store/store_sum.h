// Checksums of rows: each row of the store has one in its column `sum`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct sqlite3;

// A table whose rows have sums. The SQL function row_sum(COLUMNS), which store_sum_register makes known, is the sum;
// its last arguments may be left out when they are NULL. XXH3, which guards against accidents only.
struct store_table {
    const char *name, *columns;
    const char *key;     // the columns that identify a row; NULL: the table has one row
    bool may_be_dropped; // a damaged row without a copy is removed, and the farm goes on without it
    int first_version;   // of stores that have the table with its sums
    const char *if_lost; // what follows when a row is damaged and there is no copy
};

extern const struct store_table store_tables[]; // ends with an empty name

// To be called for each connection that reads or writes sums.
bool store_sum_register(struct sqlite3 *db, struct error *error);
// Counts the rows whose sum is wrong, and documents and jobs that lack the other. `version` is that of the store; those
// before sums have nothing to check.
bool store_sum_count_damaged(struct sqlite3 *db, int version, int64_t *count, struct error *error);
