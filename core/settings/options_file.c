// SPDX-License-Identifier: Apache-2.0
#include "core/settings/options_file.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/nearest_name.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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

static bool read_line(char *line, const struct options_file_handlers *handlers, struct error *error)
{
    char *equals, *key = trim(line);

    if (!*key || *key == '#') return true;
    equals = strchr(key, '=');
    if (!equals) {
        error_set(error, "expected KEY = VALUE, got \"%s\"", key);
        return false;
    }
    *equals = '\0';
    return handlers->on_setting(handlers->user, trim(key), trim(equals + 1), error);
}

void options_file_read(const char *path, const struct options_file_handlers *handlers)
{
    struct error error = {0};
    char *text, *rest;

    if (!file_read_text(path, SIZE_LIMIT, &text, NULL, &error)) {
        error_prefix(&error, "%s", path);
        handlers->on_mistake(handlers->user, error.message);
        return;
    }
    rest = text;
    for (int number = 1; rest; number++) {
        char *line = strsep(&rest, "\n");

        if (read_line(line, handlers, &error)) continue;
        error_prefix(&error, "%s:%d", path, number);
        handlers->on_mistake(handlers->user, error.message);
    }
    free(text);
}

char *options_file_find(const struct options_file_place *place, bool is_system)
{
    char *path = NULL;

    if (is_system)
        path = place->system_path ? xstrdup(place->system_path) : NULL;
    else if (place->config_home && *place->config_home == '/')
        path = xasprintf("%s/%s", place->config_home, place->name);
    else if (place->home)
        path = xasprintf("%s/.config/%s", place->home, place->name);
    if (path && access(path, F_OK) == 0) return path;
    free(path);
    return NULL;
}

void options_file_fail_key(const char *key, const char *const names[], const char *program, struct error *error)
{
    const char *nearest = nearest_name_find(key, names);

    if (nearest)
        error_set(error, "%s: there is no such setting, did you mean %s?", key, nearest);
    else
        error_set(error, "%s: there is no such setting, see %s --help", key, program);
}
