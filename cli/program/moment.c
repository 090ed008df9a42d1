// SPDX-License-Identifier: Apache-2.0
#include "cli/program/moment.h"

#include "core/base/error.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { DIGITS_LIMIT = 9 };

static bool parse_age(const char *text, int64_t *seconds)
{
    static const struct {
        char letter;
        int64_t seconds;
    } units[] = {{'s', 1}, {'m', 60}, {'h', 3600}, {'d', 86400}, {'w', INT64_C(7) * 86400}};
    size_t digits = strspn(text, "0123456789");

    if (digits == 0 || digits > DIGITS_LIMIT || !text[digits] || text[digits + 1]) return false;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        if (units[i].letter != text[digits]) continue;
        *seconds = strtoll(text, NULL, 10) * units[i].seconds;
        return true;
    }
    return false;
}

bool moment_parse_span(const char *text, int64_t *seconds, struct error *error)
{
    if (parse_age(text, seconds) && *seconds > 0) return true;
    error_set(error, "expected a time such as 12h or 30d, got \"%s\"", text);
    return false;
}

static bool parse_date(const char *text, int64_t *unix_s)
{
    static const char *const formats[] = {"%Y-%m-%d", "%Y-%m-%dT%H:%M", "%Y-%m-%d %H:%M"};

    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        struct tm date = {.tm_isdst = -1};
        const char *end = strptime(text, formats[i], &date);
        time_t time;

        if (!end || *end) continue;
        time = mktime(&date);
        if (time < 0) continue;
        *unix_s = time;
        return true;
    }
    return false;
}

bool moment_parse(const char *text, int64_t now_s, int64_t *unix_s, struct error *error)
{
    int64_t age_s;

    if (parse_age(text, &age_s)) {
        *unix_s = age_s < now_s ? now_s - age_s : 0;
        return true;
    }
    if (parse_date(text, unix_s)) return true;
    error_set(error, "expected an age such as 12h or 30d, or a date such as 2026-03-01 or 2026-03-01T18:30, got \"%s\"",
              text);
    return false;
}
