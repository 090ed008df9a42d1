// SPDX-License-Identifier: Apache-2.0
#include "core/json/json_scan.h"

#include "core/base/error.h"
#include "core/base/utf8.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct scanner {
    const char *text;
    size_t length;
    size_t at;
    size_t value_count;
    int depth;
    struct error *error;
};

static bool scan_value(struct scanner *scanner);

static bool fail_at(struct scanner *scanner, size_t at, const char *format, ...) __attribute__((format(printf, 3, 4)));

static bool fail_at(struct scanner *scanner, size_t at, const char *format, ...)
{
    char what[256];
    size_t line = 1, column = 1;
    va_list arguments;

    for (size_t i = 0; i < at; i++) {
        if (scanner->text[i] == '\n') {
            line++;
            column = 1;
        } else if (((unsigned char)scanner->text[i] & 0xc0) != 0x80) {
            column++;
        }
    }
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    error_set(scanner->error, "line %zu, column %zu: %s", line, column, what);
    return false;
}

// Fails with "expected WHAT, got" and the character at the scanner's position.
static bool fail_expected(struct scanner *scanner, const char *expected)
{
    unsigned char byte;

    if (scanner->at >= scanner->length)
        return fail_at(scanner, scanner->at, "expected %s, got the end of the text", expected);
    byte = (unsigned char)scanner->text[scanner->at];
    if (byte > 0x20 && byte < 0x7f) return fail_at(scanner, scanner->at, "expected %s, got '%c'", expected, byte);
    return fail_at(scanner, scanner->at, "expected %s, got byte 0x%02x", expected, byte);
}

// The byte at the scanner's position; 0, which starts no JSON token, at the end.
static char peek(const struct scanner *scanner)
{
    return scanner->at < scanner->length ? scanner->text[scanner->at] : '\0';
}

static void skip_space(struct scanner *scanner)
{
    for (; scanner->at < scanner->length; scanner->at++) {
        char c = scanner->text[scanner->at];

        if (c != ' ' && c != '\n' && c != '\t' && c != '\r') return;
    }
}

// Reads four hexadecimal digits at the scanner's position; -1 when they are not there.
static int scan_hex4(struct scanner *scanner)
{
    int code = 0;

    if (scanner->length - scanner->at < 4) return -1;
    for (int i = 0; i < 4; i++) {
        char c = scanner->text[scanner->at + (size_t)i];
        int digit = c >= '0' && c <= '9'   ? c - '0'
                    : c >= 'a' && c <= 'f' ? c - 'a' + 10
                    : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                           : -1;

        if (digit < 0) return -1;
        code = code * 16 + digit;
    }
    scanner->at += 4;
    return code;
}

static bool scan_escape(struct scanner *scanner)
{
    size_t start = scanner->at;
    int code;

    scanner->at++;
    if (scanner->at >= scanner->length) return fail_expected(scanner, "the rest of an escape");
    if (scanner->text[scanner->at] != 'u') {
        if (!scanner->text[scanner->at] || !strchr("\"\\/bfnrt", scanner->text[scanner->at]))
            return fail_expected(scanner, "one of \"\\/bfnrtu after a backslash");
        scanner->at++;
        return true;
    }
    scanner->at++;
    code = scan_hex4(scanner);
    if (code < 0) return fail_at(scanner, start, "expected four hexadecimal digits after \\u");
    if (code == 0) return fail_at(scanner, start, "\\u0000 is not allowed in a string");
    if (code >= 0xdc00 && code <= 0xdfff) return fail_at(scanner, start, "half of a surrogate pair");
    if (code >= 0xd800 && code <= 0xdbff) {
        bool follows =
            peek(scanner) == '\\' && scanner->at + 1 < scanner->length && scanner->text[scanner->at + 1] == 'u';

        if (!follows) return fail_at(scanner, start, "half of a surrogate pair");
        scanner->at += 2;
        code = scan_hex4(scanner);
        if (code < 0xdc00 || code > 0xdfff) return fail_at(scanner, start, "half of a surrogate pair");
    }
    return true;
}

static bool scan_string(struct scanner *scanner)
{
    size_t start = scanner->at;

    scanner->at++;
    while (scanner->at < scanner->length) {
        unsigned char byte = (unsigned char)scanner->text[scanner->at];

        if (byte == '"') {
            scanner->at++;
            return true;
        }
        if (byte == '\\') {
            if (!scan_escape(scanner)) return false;
        } else if (byte < 0x20) {
            return fail_at(scanner, scanner->at, "byte 0x%02x in a string: write it as an escape", byte);
        } else if (byte < 0x80) {
            scanner->at++;
        } else {
            size_t size = utf8_character_length(scanner->text + scanner->at, scanner->length - scanner->at);

            if (size == 0) return fail_at(scanner, scanner->at, "byte 0x%02x is not UTF-8", byte);
            scanner->at += size;
        }
    }
    return fail_at(scanner, start, "this string has no closing quote");
}

static bool scan_digits(struct scanner *scanner)
{
    size_t start = scanner->at;

    while (peek(scanner) >= '0' && peek(scanner) <= '9')
        scanner->at++;
    return scanner->at > start || fail_expected(scanner, "a digit");
}

static bool scan_number(struct scanner *scanner)
{
    size_t start = scanner->at;
    bool has_exponent = false;
    char digits[JSON_NUMBER_SIZE];

    if (peek(scanner) == '-') scanner->at++;
    if (peek(scanner) == '0') {
        scanner->at++;
        if (peek(scanner) >= '0' && peek(scanner) <= '9')
            return fail_at(scanner, start, "a number does not begin with a zero");
    } else if (!scan_digits(scanner)) {
        return false;
    }
    if (peek(scanner) == '.') {
        scanner->at++;
        if (!scan_digits(scanner)) return false;
    }
    if (peek(scanner) == 'e' || peek(scanner) == 'E') {
        has_exponent = true;
        scanner->at++;
        if (peek(scanner) == '+' || peek(scanner) == '-') scanner->at++;
        if (!scan_digits(scanner)) return false;
    }
    if (scanner->at - start >= sizeof digits)
        return fail_at(scanner, start, "expected a number of at most %zu characters", sizeof digits - 1);
    if (!has_exponent) return true;
    memcpy(digits, scanner->text + start, scanner->at - start);
    digits[scanner->at - start] = '\0';
    return isfinite(strtod(digits, NULL)) || fail_at(scanner, start, "the number %s is too large", digits);
}

static bool scan_word(struct scanner *scanner, const char *word)
{
    size_t size = strlen(word);

    if (scanner->length - scanner->at < size || memcmp(scanner->text + scanner->at, word, size) != 0)
        return fail_expected(scanner, "a value");
    scanner->at += size;
    return true;
}

static bool scan_member_key(struct scanner *scanner)
{
    if (peek(scanner) != '"') return fail_expected(scanner, "a key in double quotes");
    if (!scan_string(scanner)) return false;
    skip_space(scanner);
    if (peek(scanner) != ':') return fail_expected(scanner, "':' after a key");
    scanner->at++;
    skip_space(scanner);
    return true;
}

// Scans an object or an array from its opening bracket to its closing one.
static bool scan_members(struct scanner *scanner, char close)
{
    const char *expected = close == '}' ? "',' or '}'" : "',' or ']'";

    if (++scanner->depth > JSON_DEPTH_LIMIT)
        return fail_at(scanner, scanner->at, "nested deeper than %d levels", JSON_DEPTH_LIMIT);
    scanner->at++;
    skip_space(scanner);
    if (peek(scanner) != close) {
        for (;;) {
            if (close == '}' && !scan_member_key(scanner)) return false;
            if (!scan_value(scanner)) return false;
            skip_space(scanner);
            if (peek(scanner) != ',') break;
            scanner->at++;
            skip_space(scanner);
        }
        if (peek(scanner) != close) return fail_expected(scanner, expected);
    }
    scanner->at++;
    scanner->depth--;
    return true;
}

static bool scan_value(struct scanner *scanner)
{
    if (++scanner->value_count > JSON_VALUE_LIMIT)
        return fail_at(scanner, scanner->at, "more than %d values", JSON_VALUE_LIMIT);
    switch (peek(scanner)) {
    case '{':
        return scan_members(scanner, '}');
    case '[':
        return scan_members(scanner, ']');
    case '"':
        return scan_string(scanner);
    case 't':
        return scan_word(scanner, "true");
    case 'f':
        return scan_word(scanner, "false");
    case 'n':
        return scan_word(scanner, "null");
    case '-':
    case '0':
    case '1':
    case '2':
    case '3':
    case '4':
    case '5':
    case '6':
    case '7':
    case '8':
    case '9':
        return scan_number(scanner);
    default:
        return fail_expected(scanner, "a value");
    }
}

bool json_scan(const char *text, size_t length, struct error *error)
{
    struct scanner scanner = {.text = text, .length = length, .error = error};

    skip_space(&scanner);
    if (!scan_value(&scanner)) return false;
    skip_space(&scanner);
    return scanner.at == length || fail_expected(&scanner, "the end of the text");
}
