// SPDX-License-Identifier: Apache-2.0
#include "tests/support/json_edit.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct edit {
    const char *path;
    const char *value; // NULL: remove it, unless there is a `key`
    const char *key;   // the new key; NULL: the old one
    bool done;
};

static struct cJSON *parse(const char *text)
{
    struct cJSON *root;
    struct error error = {0};

    if (!json_parse(&root, text, strlen(text), &error)) {
        fprintf(stderr, "%s: %s\n", error.message, text);
        abort();
    }
    return root;
}

static void path_below(char *below, size_t size, const char *path, const struct json_node *child)
{
    if (child->key)
        snprintf(below, size, "%s%s%s", path, *path ? "." : "", child->key);
    else
        snprintf(below, size, "%s[%zu]", path, child->index);
}

// The last key of edit->path, if `path` precedes it.
static const char *key_to_append(const struct edit *edit, const char *path)
{
    size_t length = strlen(path);
    const char *rest = edit->path + length;

    if (strncmp(edit->path, path, length) != 0) return NULL;
    if (length > 0 && *rest++ != '.') return NULL;
    return *rest && !strpbrk(rest, ".[") ? rest : NULL;
}

static void write_edited(struct json_writer *writer, const struct json_node *node, const char *path, struct edit *edit)
{
    enum json_type type = json_node_type(node);
    struct json_node child = {0};
    const char *appended;
    char below[512];

    if (strcmp(path, edit->path) == 0 && edit->value) {
        edit->done = true;
        json_write_raw(writer, edit->value, strlen(edit->value));
        return;
    }
    if (type != JSON_OBJECT && type != JSON_ARRAY) {
        char *text = json_node_format(node);

        json_write_raw(writer, text, strlen(text));
        free(text);
        return;
    }
    type == JSON_OBJECT ? json_write_begin_object(writer) : json_write_begin_array(writer);
    while (json_node_next(node, &child)) {
        bool is_place;

        path_below(below, sizeof below, path, &child);
        is_place = strcmp(below, edit->path) == 0;
        edit->done = edit->done || is_place;
        if (is_place && !edit->value && !edit->key) continue;
        if (child.key) json_write_key(writer, is_place && edit->key ? edit->key : child.key);
        write_edited(writer, &child, below, edit);
    }
    appended = key_to_append(edit, path);
    if (type == JSON_OBJECT && !edit->done && edit->value && appended) {
        json_write_key(writer, appended);
        json_write_raw(writer, edit->value, strlen(edit->value));
        edit->done = true;
    }
    type == JSON_OBJECT ? json_write_end_object(writer) : json_write_end_array(writer);
}

static char *apply(const char *text, struct edit edit)
{
    struct cJSON *root = parse(text);
    struct json_node node = json_node_root(root);
    struct json_writer writer = {0};

    write_edited(&writer, &node, "", &edit);
    json_delete(root);
    if (!edit.done) {
        fprintf(stderr, "%s: no such place in %s\n", edit.path, text);
        abort();
    }
    return writer.text;
}

char *json_edit_set(const char *text, const char *path, const char *value)
{
    return apply(text, (struct edit){.path = path, .value = value});
}

char *json_edit_rename(const char *text, const char *path, const char *key)
{
    return apply(text, (struct edit){.path = path, .key = key});
}

struct place_list {
    struct json_place *places;
    size_t count, capacity;
};

static void collect(struct place_list *list, const struct json_node *node, const char *path)
{
    struct json_node child = {0};
    char below[512];

    while (json_node_next(node, &child)) {
        path_below(below, sizeof below, path, &child);
        list->places = xgrow(list->places, &list->capacity, list->count + 1, sizeof list->places[0]);
        list->places[list->count++] = (struct json_place){xstrdup(below), json_node_type(&child) == JSON_STRING};
        collect(list, &child, below);
    }
}

struct json_place *json_edit_places(const char *text, size_t *count)
{
    struct cJSON *root = parse(text);
    struct json_node node = json_node_root(root);
    struct place_list list = {0};

    collect(&list, &node, "");
    json_delete(root);
    *count = list.count;
    return list.places;
}

void json_edit_free_places(struct json_place *places, size_t count)
{
    for (size_t i = 0; i < count; i++)
        free(places[i].path);
    free(places);
}
