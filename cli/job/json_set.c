// SPDX-License-Identifier: Apache-2.0
#include "cli/job/json_set.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"
#include "core/json/json_scan.h"
#include "core/json/json_write.h"

#include <stdlib.h>
#include <string.h>

enum { STEP_LIMIT = JSON_DEPTH_LIMIT, INDEX_DIGITS_LIMIT = 7 };

// One part of a path: a key, or an index when `key` is NULL.
struct step {
    char *key; // owned
    size_t index;
    size_t end; // offset behind this step in the path
};

struct edit {
    const char *path; // borrowed
    struct step steps[STEP_LIMIT];
    size_t step_count;
    const char *value; // borrowed; the right side of the assignment
    bool value_is_json, value_is_number;
    bool takes;  // the member is taken out in place of being set
    char *taken; // owned; its value; NULL: not met yet
    struct json_writer writer;
};

static void finish(struct edit *edit)
{
    for (size_t i = 0; i < STEP_LIMIT; i++)
        free(edit->steps[i].key);
    json_writer_finish(&edit->writer);
}

static bool fail_path(const struct edit *edit, struct error *error, size_t step, const char *why)
{
    error_set(error, "%.*s: %s", (int)edit->steps[step].end, edit->path, why);
    return false;
}

static bool parse_index(struct step *step, const char **cursor)
{
    const char *digits = *cursor + 1;
    size_t count = strspn(digits, "0123456789");

    if (count == 0 || count > INDEX_DIGITS_LIMIT || digits[count] != ']') return false;
    step->index = strtoul(digits, NULL, 10);
    *cursor = digits + count + 1;
    return true;
}

static bool parse_path(struct edit *edit, struct error *error)
{
    const char *cursor = edit->path;

    while (*cursor) {
        struct step *step = &edit->steps[edit->step_count];

        if (edit->step_count == STEP_LIMIT) {
            error_set(error, "%s: more than %d levels", edit->path, STEP_LIMIT);
            return false;
        }
        if (*cursor == '[') {
            if (!parse_index(step, &cursor)) goto syntax;
        } else {
            size_t length;

            if (cursor != edit->path && *cursor != '.') goto syntax;
            if (cursor != edit->path) cursor++;
            length = strcspn(cursor, ".[]");
            if (length == 0) goto syntax;
            step->key = xstrndup(cursor, length);
            cursor += length;
        }
        step->end = (size_t)(cursor - edit->path);
        edit->step_count++;
    }
    if (edit->step_count > 0) return true;
syntax:
    error_set(error, "\"%s\": expected a path such as scene.media[0].sigma_s", edit->path);
    return false;
}

// A job has a number or a name there. Elsewhere a string that is replaced by a number stays a string: frames=48 means
// "48".
static bool is_number_or_name(const struct edit *edit)
{
    return strcmp(edit->path, "scene.scattering.orders") == 0;
}

static void write_value(struct edit *edit)
{
    if (edit->value_is_json)
        json_write_raw(&edit->writer, edit->value, strlen(edit->value));
    else
        json_write_string(&edit->writer, edit->value);
}

// Writes the objects and arrays that the steps from `step` on lack, and the value.
static bool write_missing(struct edit *edit, size_t step, struct error *error)
{
    bool ok;

    if (step == edit->step_count) {
        write_value(edit);
        return true;
    }
    if (edit->steps[step].key) {
        json_write_begin_object(&edit->writer);
        json_write_key(&edit->writer, edit->steps[step].key);
        ok = write_missing(edit, step + 1, error);
        json_write_end_object(&edit->writer);
        return ok;
    }
    if (edit->steps[step].index != 0)
        return fail_path(edit, error, step, "the array has no elements, only [0] can be added");
    json_write_begin_array(&edit->writer);
    ok = write_missing(edit, step + 1, error);
    json_write_end_array(&edit->writer);
    return ok;
}

static void write_unchanged(struct edit *edit, const struct json_node *node)
{
    char *text = json_node_format(node);

    json_write_raw(&edit->writer, text, strlen(text));
    free(text);
}

static bool write_edited(struct edit *edit, const struct json_node *node, size_t step, struct error *error);

static bool write_edited_object(struct edit *edit, const struct json_node *object, size_t step, struct error *error)
{
    const char *key = edit->steps[step].key;
    struct json_node child = {0};
    bool found = false, ok = true;

    json_write_begin_object(&edit->writer);
    while (ok && json_node_next(object, &child)) {
        bool is_on_path = strcmp(child.key, key) == 0;

        found |= is_on_path;
        if (is_on_path && edit->takes && step + 1 == edit->step_count) {
            edit->taken = json_node_format(&child);
            continue;
        }
        json_write_key(&edit->writer, child.key);
        if (is_on_path)
            ok = write_edited(edit, &child, step + 1, error);
        else
            write_unchanged(edit, &child);
    }
    if (edit->takes) ok &= found;
    if (ok && !found) {
        json_write_key(&edit->writer, key);
        ok = write_missing(edit, step + 1, error);
    }
    json_write_end_object(&edit->writer);
    return ok;
}

static bool write_edited_array(struct edit *edit, const struct json_node *array, size_t step, struct error *error)
{
    size_t index = edit->steps[step].index, count = json_node_count(array);
    struct json_node child = {0};
    bool ok = true;

    if (index > count) {
        error_set(error, "%.*s: the array has %zu element%s, index %zu would append", (int)edit->steps[step].end,
                  edit->path, count, count == 1 ? "" : "s", count);
        return false;
    }
    json_write_begin_array(&edit->writer);
    while (ok && json_node_next(array, &child)) {
        if (child.index == index)
            ok = write_edited(edit, &child, step + 1, error);
        else
            write_unchanged(edit, &child);
    }
    if (ok && index == count) ok = write_missing(edit, step + 1, error);
    json_write_end_array(&edit->writer);
    return ok;
}

static bool write_edited(struct edit *edit, const struct json_node *node, size_t step, struct error *error)
{
    if (step == edit->step_count) {
        if (json_node_type(node) == JSON_STRING && edit->value_is_number && !is_number_or_name(edit))
            edit->value_is_json = false;
        write_value(edit);
        return true;
    }
    if (edit->steps[step].key) {
        if (json_node_type(node) == JSON_OBJECT) return write_edited_object(edit, node, step, error);
        return fail_path(edit, error, step, "its parent is no object");
    }
    if (json_node_type(node) == JSON_ARRAY) return write_edited_array(edit, node, step, error);
    return fail_path(edit, error, step, "its parent is no array");
}

char *json_set(const char *document, const char *assignment, struct error *error)
{
    struct edit edit = {0};
    struct cJSON *root = NULL, *value = NULL;
    const char *equals = strchr(assignment, '=');
    char *path = NULL, *edited = NULL;
    struct json_node node;

    if (!equals) {
        error_set(error, "\"%s\": expected PATH=VALUE", assignment);
        return NULL;
    }
    path = xstrndup(assignment, (size_t)(equals - assignment));
    edit.path = path;
    edit.value = equals + 1;
    edit.value_is_json = json_parse(&value, edit.value, strlen(edit.value), NULL);
    node = json_node_root(value);
    edit.value_is_number = edit.value_is_json && json_node_type(&node) == JSON_NUMBER;
    if (!parse_path(&edit, error)) goto out;
    if (!json_parse(&root, document, strlen(document), error)) goto out;
    node = json_node_root(root);
    if (!write_edited(&edit, &node, 0, error)) goto out;
    edited = xstrdup(edit.writer.text);
out:
    finish(&edit);
    json_delete(value);
    json_delete(root);
    free(path);
    return edited;
}

char *json_take(const char *document, const char *path, char **value)
{
    struct edit edit = {.path = path, .takes = true};
    struct cJSON *root = NULL;
    struct json_node node;
    char *edited = NULL;

    if (parse_path(&edit, NULL) && json_parse(&root, document, strlen(document), NULL)) {
        node = json_node_root(root);
        if (write_edited(&edit, &node, 0, NULL) && edit.taken) edited = xstrdup(edit.writer.text);
    }
    if (edited && value) {
        *value = edit.taken;
        edit.taken = NULL;
    }
    free(edit.taken);
    finish(&edit);
    json_delete(root);
    return edited;
}

bool json_set_text(char **document, const char *path, const char *text, struct error *error)
{
    struct json_writer assignment = {0};
    char *whole, *edited;

    json_write_string(&assignment, text);
    whole = xasprintf("%s=%s", path, assignment.text);
    edited = json_set(*document, whole, error);
    json_writer_finish(&assignment);
    free(whole);
    if (!edited) return false;
    free(*document);
    *document = edited;
    return true;
}
