// SPDX-License-Identifier: Apache-2.0
#include "core/json/json_write.h"

#include "core/base/alloc.h"
#include "core/base/utf8.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Makes room for `size_bytes` more and a NUL.
static char *reserve(struct json_writer *writer, size_t size_bytes)
{
    if (writer->capacity - writer->length <= size_bytes)
        writer->text = xgrow(writer->text, &writer->capacity, writer->length + size_bytes + 1, 1);
    return writer->text + writer->length;
}

static void append(struct json_writer *writer, const char *bytes, size_t size_bytes)
{
    char *end = reserve(writer, size_bytes);

    memcpy(end, bytes, size_bytes);
    end[size_bytes] = '\0';
    writer->length += size_bytes;
}

// Appends one value as it is, after a comma where one is needed.
static void append_value(struct json_writer *writer, const char *bytes, size_t size_bytes)
{
    if (writer->wants_comma) append(writer, ",", 1);
    append(writer, bytes, size_bytes);
    writer->wants_comma = true;
}

void json_writer_finish(struct json_writer *writer)
{
    free(writer->text);
    *writer = (struct json_writer){0};
}

void json_writer_clear(struct json_writer *writer)
{
    writer->length = 0;
    writer->wants_comma = false;
    if (writer->text) writer->text[0] = '\0';
}

void json_write_begin_object(struct json_writer *writer)
{
    append_value(writer, "{", 1);
    writer->wants_comma = false;
}

void json_write_end_object(struct json_writer *writer)
{
    append(writer, "}", 1);
    writer->wants_comma = true;
}

void json_write_begin_array(struct json_writer *writer)
{
    append_value(writer, "[", 1);
    writer->wants_comma = false;
}

void json_write_end_array(struct json_writer *writer)
{
    append(writer, "]", 1);
    writer->wants_comma = true;
}

static bool is_plain(unsigned char byte)
{
    return byte >= 0x20 && byte < 0x80 && byte != '"' && byte != '\\';
}

static void append_escape(struct json_writer *writer, unsigned char byte)
{
    static const char short_escapes[][2] = {{'"', '"'},  {'\\', '\\'}, {'\n', 'n'}, {'\t', 't'},
                                            {'\r', 'r'}, {'\b', 'b'},  {'\f', 'f'}};
    char escape[8] = "\\";

    for (size_t i = 0; i < sizeof short_escapes / sizeof short_escapes[0]; i++) {
        if (byte == (unsigned char)short_escapes[i][0]) {
            escape[1] = short_escapes[i][1];
            append(writer, escape, 2);
            return;
        }
    }
    snprintf(escape, sizeof escape, "\\u%04x", byte);
    append(writer, escape, 6);
}

static void append_quoted(struct json_writer *writer, const char *text)
{
    size_t length = strlen(text);
    size_t at = 0;

    append(writer, "\"", 1);
    while (at < length) {
        size_t run = at;
        size_t size;

        while (run < length && is_plain((unsigned char)text[run]))
            run++;
        append(writer, text + at, run - at);
        at = run;
        if (at == length) break;
        if ((unsigned char)text[at] < 0x80) {
            append_escape(writer, (unsigned char)text[at++]);
            continue;
        }
        size = utf8_character_length(text + at, length - at);
        if (size > 0)
            append(writer, text + at, size);
        else
            append(writer, "\xef\xbf\xbd", 3);
        at += size > 0 ? size : 1;
    }
    append(writer, "\"", 1);
}

void json_write_key(struct json_writer *writer, const char *key)
{
    if (writer->wants_comma) append(writer, ",", 1);
    append_quoted(writer, key);
    append(writer, ":", 1);
    writer->wants_comma = false;
}

void json_write_string(struct json_writer *writer, const char *text)
{
    if (!text) {
        json_write_null(writer);
        return;
    }
    if (writer->wants_comma) append(writer, ",", 1);
    append_quoted(writer, text);
    writer->wants_comma = true;
}

// Writes `integer` in decimal so that it ends before `end`; returns its start.
static char *format_integer(char *end, int64_t integer)
{
    uint64_t remaining = integer < 0 ? -(uint64_t)integer : (uint64_t)integer;

    do {
        *--end = (char)('0' + remaining % 10);
        remaining /= 10;
    } while (remaining > 0);
    if (integer < 0) *--end = '-';
    return end;
}

void json_write_integer(struct json_writer *writer, int64_t integer)
{
    char digits[24];
    char *end = digits + sizeof digits;
    char *start = format_integer(end, integer);

    append_value(writer, start, (size_t)(end - start));
}

// Formats a whole number of millionths, as most numbers here are. An integer below 2^53 divided by 10^6 rounds to the
// double nearest to that decimal, so equality proves that the decimal reads back. Returns its length, or 0 for other
// numbers.
static int format_millionths(char text[static 32], double number)
{
    double scaled = number * 1e6;
    int64_t millionths, fraction;
    int digits = 6;

    if (!(fabs(scaled) >= 1e2 && fabs(scaled) < 1e15)) return 0;
    millionths = llround(fabs(scaled));
    fraction = millionths % 1000000;
    if (fraction == 0 || (double)millionths / 1e6 != fabs(number)) return 0;
    for (; fraction % 10 == 0; digits--)
        fraction /= 10;
    return snprintf(text, 32, "%s%" PRId64 ".%0*" PRId64, number < 0 ? "-" : "", millionths / 1000000, digits,
                    fraction);
}

void json_write_number(struct json_writer *writer, double number)
{
    char text[32];
    int length;

    if (!isfinite(number)) {
        json_write_null(writer);
        return;
    }
    if (number == rint(number) && fabs(number) < 1e15 && !(number == 0 && signbit(number))) {
        json_write_integer(writer, (int64_t)number);
        return;
    }
    length = format_millionths(text, number);
    for (int precision = 15; length == 0; precision++) {
        int written = snprintf(text, sizeof text, "%.*g", precision, number);

        if (precision == 17 || strtod(text, NULL) == number) length = written;
    }
    append_value(writer, text, (size_t)length);
}

void json_write_bool(struct json_writer *writer, bool value)
{
    append_value(writer, value ? "true" : "false", value ? 4 : 5);
}

void json_write_null(struct json_writer *writer)
{
    append_value(writer, "null", 4);
}

void json_write_raw(struct json_writer *writer, const char *json, size_t length)
{
    append_value(writer, json, length);
}

void json_write_string_member(struct json_writer *writer, const char *key, const char *text)
{
    json_write_key(writer, key);
    json_write_string(writer, text);
}

void json_write_number_member(struct json_writer *writer, const char *key, double number)
{
    json_write_key(writer, key);
    json_write_number(writer, number);
}

void json_write_integer_member(struct json_writer *writer, const char *key, int64_t integer)
{
    json_write_key(writer, key);
    json_write_integer(writer, integer);
}

void json_write_bool_member(struct json_writer *writer, const char *key, bool value)
{
    json_write_key(writer, key);
    json_write_bool(writer, value);
}
