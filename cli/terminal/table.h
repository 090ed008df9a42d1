// Rows of text in aligned columns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct table_column {
    const char *title; // borrowed; in capitals as listings have it
    bool is_right;     // aligned to the right, as numbers are
};

// `columns` is borrowed, the rest is owned. Start with columns and column_count set and the rest zero.
struct table {
    const struct table_column *columns;
    size_t column_count;
    char **cells; // owned; row by row
    size_t cell_count, capacity;
};

void table_finish(struct table *table);
// Cells are added from left to right; a row is whole when every column has one. NULL is shown as "-". Control bytes
// become "?", so that no name can move the cursor.
void table_add(struct table *table, const char *cell);
void table_add_format(struct table *table, const char *format, ...) __attribute__((format(printf, 2, 3)));
// The text with a newline after each row; the first line holds the titles if `has_titles`. Owned by the caller.
char *table_format(const struct table *table, bool has_titles);

// How many terminal columns `text` takes: one a code point.
size_t table_text_width(const char *text);
