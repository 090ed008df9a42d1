// SPDX-License-Identifier: Apache-2.0
#include "cli/terminal/table.h"

#include "core/base/alloc.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GAP = 2 };

void table_finish(struct table *table)
{
    for (size_t i = 0; i < table->cell_count; i++)
        free(table->cells[i]);
    free(table->cells);
    table->cells = NULL;
    table->cell_count = table->capacity = 0;
}

static void add_owned(struct table *table, char *cell)
{
    for (char *byte = cell; *byte; byte++)
        if ((unsigned char)*byte < 0x20 || *byte == 0x7f) *byte = '?';
    table->cells = xgrow(table->cells, &table->capacity, table->cell_count + 1, sizeof *table->cells);
    table->cells[table->cell_count++] = cell;
}

void table_add(struct table *table, const char *cell)
{
    add_owned(table, xstrdup(cell ? cell : "-"));
}

void table_add_format(struct table *table, const char *format, ...)
{
    char *cell = NULL;
    va_list arguments;

    va_start(arguments, format);
    if (vasprintf(&cell, format, arguments) < 0) abort();
    va_end(arguments);
    add_owned(table, cell);
}

size_t table_text_width(const char *text)
{
    size_t width = 0;

    for (; *text; text++)
        if (((unsigned char)*text & 0xc0) != 0x80) width++;
    return width;
}

static size_t column_width(const struct table *table, size_t column, bool has_titles)
{
    size_t widest = has_titles ? table_text_width(table->columns[column].title) : 0;

    for (size_t i = column; i < table->cell_count; i += table->column_count) {
        size_t width = table_text_width(table->cells[i]);

        if (width > widest) widest = width;
    }
    return widest;
}

static void write_cell(FILE *out, const struct table *table, size_t column, size_t width, const char *cell)
{
    int padding = (int)(width - table_text_width(cell));
    bool is_last = column + 1 == table->column_count;

    if (column > 0) fprintf(out, "%*s", GAP, "");
    if (table->columns[column].is_right) fprintf(out, "%*s", padding, "");
    fputs(cell, out);
    if (!table->columns[column].is_right && !is_last) fprintf(out, "%*s", padding, "");
    if (is_last) fputc('\n', out);
}

char *table_format(const struct table *table, bool has_titles)
{
    size_t *widths = xcalloc(table->column_count, sizeof *widths);
    char *text = NULL;
    size_t length = 0;
    FILE *out = open_memstream(&text, &length);

    if (!out) abort();
    for (size_t column = 0; column < table->column_count; column++)
        widths[column] = column_width(table, column, has_titles);
    for (size_t column = 0; has_titles && column < table->column_count; column++)
        write_cell(out, table, column, widths[column], table->columns[column].title);
    for (size_t i = 0, column = 0; i < table->cell_count; i++) {
        write_cell(out, table, column, widths[column], table->cells[i]);
        if (++column == table->column_count) column = 0;
    }
    fclose(out);
    free(widths);
    return text;
}
