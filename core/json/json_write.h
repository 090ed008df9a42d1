// Writes compact JSON into a growing text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// The zero value is an empty text. The writer puts commas where they belong.
struct json_writer {
    char *text; // owned; NUL-terminated once something is written
    size_t length;
    size_t capacity;
    bool wants_comma;
};

void json_writer_finish(struct json_writer *writer);
void json_writer_clear(struct json_writer *writer); // keeps the memory

void json_write_begin_object(struct json_writer *writer);
void json_write_end_object(struct json_writer *writer);
void json_write_begin_array(struct json_writer *writer);
void json_write_end_array(struct json_writer *writer);
void json_write_key(struct json_writer *writer, const char *key);
// NULL writes null; bytes that are not UTF-8 become U+FFFD.
void json_write_string(struct json_writer *writer, const char *text);
void json_write_number(struct json_writer *writer, double number); // shortest that reads back; null when not finite
void json_write_integer(struct json_writer *writer, int64_t integer);
void json_write_bool(struct json_writer *writer, bool value);
void json_write_null(struct json_writer *writer);
void json_write_raw(struct json_writer *writer, const char *json, size_t length); // one value, already JSON

// Each writes a member: key and value.
void json_write_string_member(struct json_writer *writer, const char *key, const char *text);
void json_write_number_member(struct json_writer *writer, const char *key, double number);
void json_write_integer_member(struct json_writer *writer, const char *key, int64_t integer);
void json_write_bool_member(struct json_writer *writer, const char *key, bool value);
