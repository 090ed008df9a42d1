// SPDX-License-Identifier: Apache-2.0
#include "core/settings/options_value.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

bool options_value_count(const char *name, const char *text, int max, int *count, struct error *error)
{
    char *end = NULL;
    long integer;

    errno = 0;
    integer = strtol(text, &end, 10);
    if (errno == 0 && end != text && !*end && integer >= 1 && integer <= max) {
        *count = (int)integer;
        return true;
    }
    error_set(error, "--%s: expected a whole number from 1 to %d, got \"%s\"", name, max, text);
    return false;
}

bool options_value_seconds(const char *name, const char *text, double min, int64_t *ms, struct error *error)
{
    char *end = NULL;
    double seconds = strtod(text, &end);

    if (end != text && !*end && seconds >= min && seconds <= 86400) {
        *ms = (int64_t)(seconds * 1000);
        return true;
    }
    error_set(error, "--%s: expected seconds from %g to 86400, got \"%s\"", name, min, text);
    return false;
}

bool options_value_workers(const char *text, int *count, struct error *error)
{
    *count = 0;
    if (strcmp(text, "auto") == 0) return true;
    if (options_value_count("workers", text, 1024, count, NULL)) return true;
    *count = -1;
    if (strcmp(text, "none") == 0) return true;
    error_set(error, "--workers: expected \"auto\", \"none\" or a whole number from 1 to 1024, got \"%s\"", text);
    return false;
}

static bool parse_amount(const char *text, int64_t kilo, int64_t *amount)
{
    static const char letters[] = "KMGT";
    char *end = NULL;
    const char *letter;

    errno = 0;
    *amount = strtoll(text, &end, 10);
    if (errno != 0 || end == text || *amount < 1) return false;
    letter = *end ? strchr(letters, *end) : NULL;
    if (*end && (!letter || end[1])) return false;
    for (const char *step = letters; letter && step <= letter; step++)
        if (__builtin_mul_overflow(*amount, kilo, amount)) return false;
    return true;
}

bool options_value_limit(const char *name, const char *text, int64_t kilo, int64_t none, int64_t *limit,
                         struct error *error)
{
    *limit = none;
    if (strcmp(text, "none") == 0 || parse_amount(text, kilo, limit)) return true;
    error_set(error, "--%s: expected \"none\" or a whole number from 1, which may end in K, M, G or T, got \"%s\"",
              name, text);
    return false;
}

bool options_value_memory(const char *name, const char *text, int64_t *size_bytes, struct error *error)
{
    *size_bytes = 0;
    return strcmp(text, "auto") == 0 || options_value_limit(name, text, 1024, -1, size_bytes, error);
}

bool options_value_switch(const char *name, const char *text, bool *is_on, struct error *error)
{
    *is_on = strcmp(text, "yes") == 0;
    if (*is_on || strcmp(text, "no") == 0) return true;
    error_set(error, "--%s: expected yes or no, got \"%s\"", name, text);
    return false;
}

bool options_value_name(const char *name, const char *text, bool may_be_empty, char **value, struct error *error)
{
    if (!*text && !may_be_empty) {
        error_set(error, "--%s: expected a name, got nothing", name);
        return false;
    }
    free(*value);
    *value = xstrdup(text);
    return true;
}

bool options_value_backend(const char *text, char **backend, struct error *error)
{
    if (strcmp(text, "auto") != 0 && strcmp(text, "egl") != 0 && strcmp(text, "osmesa") != 0 &&
        strcmp(text, "software") != 0) {
        error_set(error, "--backend: expected auto, egl, osmesa or software, got \"%s\"", text);
        return false;
    }
    free(*backend);
    *backend = xstrdup(text);
    return true;
}

bool options_value_level(const char *text, enum log_level *level, struct error *error)
{
    static const char *const names[] = {"debug", "info", "warning", "error"};

    for (int i = 0; i < 4; i++) {
        if (strcmp(text, names[i]) != 0) continue;
        *level = (enum log_level)i;
        return true;
    }
    error_set(error, "--log-level: expected debug, info, warning or error, got \"%s\"", text);
    return false;
}

char *options_value_path(const char *name, const char *text, const char *current_folder, struct error *error)
{
    char *path;

    if (!*text) {
        error_set(error, "--%s: expected a path, got nothing", name);
        return NULL;
    }
    if (text[0] != '/' && !current_folder) {
        error_set(error, "--%s: expected an absolute path, got \"%s\"", name, text);
        return NULL;
    }
    path = text[0] == '/' ? xstrdup(text) : xasprintf("%s/%s", current_folder, text);
    for (size_t length = strlen(path); length > 1 && path[length - 1] == '/'; length--)
        path[length - 1] = '\0';
    return path;
}
