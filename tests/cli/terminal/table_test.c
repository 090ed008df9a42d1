// SPDX-License-Identifier: Apache-2.0
#include "cli/terminal/table.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const struct table_column columns[] = {{"ID", true}, {"NAME", false}, {"STATE", false}};

static void assert_formatted(struct table *table, bool has_titles, const char *expected)
{
    char *text = table_format(table, has_titles);

    assert_string_equal(text, expected);
    free(text);
    table_finish(table);
}

static void columns_are_as_wide_as_their_widest_cell(void **state)
{
    struct table table = {.columns = columns, .column_count = 3};

    table_add_format(&table, "%d", 7);
    table_add(&table, "cloud");
    table_add(&table, "running");
    table_add_format(&table, "%d", 1234);
    table_add(&table, "x");
    table_add(&table, "");
    assert_formatted(&table, true, "  ID  NAME   STATE\n   7  cloud  running\n1234  x      \n");
}

static void code_points_count_not_bytes(void **state)
{
    struct table table = {.columns = columns, .column_count = 3};

    table_add(&table, "1");
    table_add(&table, "n\xc3\xa9t");
    table_add(&table, "a");
    table_add(&table, "2");
    table_add(&table, "net");
    table_add(&table, "b");
    assert_formatted(&table, false, "1  n\xc3\xa9t  a\n2  net  b\n");
}

static void control_bytes_cannot_move_the_cursor(void **state)
{
    struct table table = {.columns = columns, .column_count = 3};

    table_add(&table, NULL);
    table_add(&table, "a\033[2Jb");
    table_add(&table, "c\nd");
    assert_formatted(&table, false, "-  a?[2Jb  c?d\n");
}

static void table_without_rows_is_its_titles(void **state)
{
    struct table table = {.columns = columns, .column_count = 3};

    assert_formatted(&table, true, "ID  NAME  STATE\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_are_as_wide_as_their_widest_cell),
        cmocka_unit_test(code_points_count_not_bytes),
        cmocka_unit_test(control_bytes_cannot_move_the_cursor),
        cmocka_unit_test(table_without_rows_is_its_titles),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
