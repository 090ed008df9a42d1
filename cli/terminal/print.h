// Prints results to standard output.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct json_node;
struct json_writer;
struct table;

void print_json(const struct json_node *node);          // compact, and a newline
void print_json_text(const struct json_writer *writer); // likewise
void print_table(const struct table *table);            // with titles
// "2024-05-01 12:00:03" in local time, or "-" when negative.
enum { PRINT_TIME_SIZE = 32 };
void print_format_time(double unix_seconds, char text[static PRINT_TIME_SIZE]);
