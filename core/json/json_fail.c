// SPDX-License-Identifier: Apache-2.0
#include "core/json/json_fail.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/nearest_name.h"
#include "core/base/utf8.h"
#include "core/json/json_write.h"

#include <cjson/cJSON.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN_BYTES = 40, PATH_SIZE = 400 };

static bool is_plain_key(const char *key)
{
    size_t length = strlen(key);

    return length > 0 && length <= SHOWN_BYTES &&
           strspn(key, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") == length;
}

// Appends `text` in quotes, shortened and escaped.
static void append_shown_string(struct json_writer *writer, const char *text)
{
    size_t length = strlen(text), shown = utf8_prefix_length(text, length, SHOWN_BYTES);
    char *prefix = xasprintf("%.*s%s", (int)shown, text, shown < length ? "..." : "");

    json_write_string(writer, prefix);
    free(prefix);
}

static void append_path(struct json_writer *writer, const struct json_node *node)
{
    char *step;

    if (node->parent) append_path(writer, node->parent);
    writer->wants_comma = false;
    if (node->key && is_plain_key(node->key)) {
        step = xasprintf("%s%s", writer->length > 0 ? "." : "", node->key);
        json_write_raw(writer, step, strlen(step));
        free(step);
    } else if (node->key) {
        json_write_begin_array(writer);
        append_shown_string(writer, node->key);
        json_write_end_array(writer);
    } else if (node->parent) {
        json_write_begin_array(writer);
        json_write_integer(writer, (int64_t)node->index);
        json_write_end_array(writer);
    }
}

bool json_fail(const struct json_node *node, struct error *error, const char *format, ...)
{
    struct json_writer path = {0};
    char message[sizeof error->message];
    va_list arguments;

    if (!error) return false;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    append_path(&path, node);
    if (path.length > PATH_SIZE)
        error_set(error, "...%s: %s", path.text + path.length - PATH_SIZE, message);
    else if (path.length > 0)
        error_set(error, "%s: %s", path.text, message);
    else
        error_set(error, "%s", message);
    json_writer_finish(&path);
    return false;
}

// The value in a few words; owned by the caller.
static char *describe_value(const struct json_node *node)
{
    struct json_writer writer = {0};

    switch (json_node_type(node)) {
    case JSON_ABSENT:
        return xstrdup("nothing");
    case JSON_ARRAY:
        return xasprintf("an array of %zu", json_node_count(node));
    case JSON_OBJECT:
        return xstrdup("an object");
    case JSON_STRING:
        append_shown_string(&writer, node->value->valuestring);
        return writer.text;
    default:
        return json_node_format(node);
    }
}

bool json_fail_expected(const struct json_node *node, struct error *error, const char *expected)
{
    char *got = describe_value(node);

    json_fail(node, error, "expected %s, got %s", expected, got);
    free(got);
    return false;
}

bool json_fail_choice(const struct json_node *node, struct error *error, const char *const names[])
{
    struct json_writer expected = {0};
    const char *text = cJSON_GetStringValue(node->value);
    const char *nearest = text ? nearest_name_find(text, names) : NULL;
    char *got = describe_value(node);

    for (int i = 0; names[i]; i++)
        json_write_string(&expected, names[i]);
    json_fail(node, error, "expected one of %s, got %s%s%s%s", expected.text ? expected.text : "nothing", got,
              nearest ? ", did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
    free(got);
    json_writer_finish(&expected);
    return false;
}

// "a, b, c"; owned by the caller.
static char *list_names(const char *const names[])
{
    char *list = xstrdup("");

    for (size_t i = 0; names[i]; i++) {
        char *longer = xasprintf("%s%s%s", list, i ? ", " : "", names[i]);

        free(list);
        list = longer;
    }
    return list;
}

bool json_fail_key(const struct json_node *object, struct error *error, const char *key, const char *const names[])
{
    struct json_node kind = json_node_child(object, "kind"), method = json_node_child(object, "method");
    const struct json_node *choice = cJSON_IsString(kind.value) ? &kind : &method;
    const char *chosen_text = cJSON_GetStringValue(choice->value);
    const char *nearest = nearest_name_find(key, names);
    struct json_writer shown = {0}, chosen = {0};
    char *known;

    append_shown_string(&shown, key);
    if (chosen_text) append_shown_string(&chosen, chosen_text);
    known = list_names(names);
    if (nearest)
        json_fail(object, error, "unknown key %s, did you mean \"%s\"?", shown.text, nearest);
    else if (chosen.text && strcmp(key, choice->key) != 0)
        json_fail(object, error, "unknown key %s beside %s %s; known: %s", shown.text, choice->key, chosen.text, known);
    else
        json_fail(object, error, "unknown key %s; known: %s", shown.text, known);
    free(known);
    json_writer_finish(&shown);
    json_writer_finish(&chosen);
    return false;
}
