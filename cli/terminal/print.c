// SPDX-License-Identifier: Apache-2.0
#include "cli/terminal/print.h"

#include "cli/terminal/table.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

void print_json(const struct json_node *node)
{
    char *text = json_node_format(node);

    puts(text);
    fflush(stdout);
    free(text);
}

void print_json_text(const struct json_writer *writer)
{
    puts(writer->text);
    fflush(stdout);
}

void print_table(const struct table *table)
{
    char *text = table_format(table, true);

    fputs(text, stdout);
    free(text);
}

void print_format_time(double unix_seconds, char text[static PRINT_TIME_SIZE])
{
    time_t seconds = (time_t)unix_seconds;
    struct tm broken;

    if (unix_seconds < 0 || !localtime_r(&seconds, &broken) ||
        strftime(text, PRINT_TIME_SIZE, "%Y-%m-%d %H:%M:%S", &broken) == 0)
        snprintf(text, PRINT_TIME_SIZE, "-");
}
