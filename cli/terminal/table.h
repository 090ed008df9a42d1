// Rows of text in aligned columns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct table_column {
    const char *title; // borrowed; in capitals
    bool is_right;     // aligned to the right, for numbers
};

// `columns` is borrowed, the rest is owned. Start with columns and column_count set and the rest zero.
struct table {
    const struct table_column *columns;
    size_t column_count;
    char **cells; // owned; row by row
    size_t cell_count, capacity;
};

void table_finish(struct table *table);
// Adds the next cell, row by row from left to right. NULL is shown as "-". Control bytes become "?", so that no name
// can move the cursor.
void table_add(struct table *table, const char *cell);
void table_add_format(struct table *table, const char *format, ...) __attribute__((format(printf, 2, 3)));
// The table as text, a newline after each row, with a first line of titles if `has_titles`. Owned by the caller.
char *table_format(const struct table *table, bool has_titles);

// The terminal columns that `text` takes: one for each code point.
size_t table_text_width(const char *text);
