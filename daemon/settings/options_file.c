// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/options_file.h"

#include "core/base/error.h"
#include "core/base/file.h"

#include <stdlib.h>
#include <string.h>

enum { SIZE_LIMIT = 1 << 16 };

static char *trim(char *text)
{
    size_t length;

    text += strspn(text, " \t\r");
    length = strlen(text);
    while (length > 0 && strchr(" \t\r", text[length - 1]))
        length--;
    text[length] = '\0';
    return text;
}

static bool read_line(char *line, options_file_on_setting *on_setting, void *user, struct error *error)
{
    char *equals, *key = trim(line);

    if (!*key || *key == '#') return true;
    equals = strchr(key, '=');
    if (!equals) {
        error_set(error, "expected KEY = VALUE, got \"%s\"", key);
        return false;
    }
    *equals = '\0';
    return on_setting(user, trim(key), trim(equals + 1), error);
}

bool options_file_read(const char *path, options_file_on_setting *on_setting, void *user, struct error *error)
{
    char *text, *rest;
    bool ok = true;

    if (!file_read_text(path, SIZE_LIMIT, &text, NULL, error)) {
        error_prefix(error, "%s", path);
        return false;
    }
    rest = text;
    for (int number = 1; ok && rest; number++) {
        char *line = strsep(&rest, "\n");

        ok = read_line(line, on_setting, user, error);
        if (!ok) error_prefix(error, "%s:%d", path, number);
    }
    free(text);
    return ok;
}
