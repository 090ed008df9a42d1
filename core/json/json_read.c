// SPDX-License-Identifier: Apache-2.0
#include "core/json/json_read.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/base/utf8.h"
#include "core/json/json_scan.h"
#include "core/json/json_write.h"

#include <assert.h>
#include <cjson/cJSON.h>
#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN_BYTES = 40, PATH_SIZE = 400 };

static int compare_keys(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

// A key that `object` has twice, or NULL.
static const char *find_repeated_key(const cJSON *object)
{
    const char *few[16];
    const char **keys = few;
    const char *repeated = NULL;
    size_t count = 0;

    for (const cJSON *member = object->child; member; member = member->next)
        count++;
    if (count > sizeof few / sizeof few[0]) keys = xmalloc(count * sizeof keys[0]);
    count = 0;
    for (const cJSON *member = object->child; member; member = member->next)
        keys[count++] = member->string;
    qsort(keys, count, sizeof keys[0], compare_keys);
    for (size_t i = 1; i < count && !repeated; i++)
        if (strcmp(keys[i - 1], keys[i]) == 0) repeated = keys[i];
    if (keys != few) free(keys);
    return repeated;
}

static bool check_repeated_keys(const struct json_node *node, struct error *error)
{
    struct json_node child = {0};

    if (cJSON_IsObject(node->value)) {
        const char *key = find_repeated_key(node->value);

        if (key) {
            child = (struct json_node){.value = node->value, .parent = node, .key = key};
            return json_fail(&child, error, "the key appears twice");
        }
    }
    while (json_node_next(node, &child))
        if (child.value->child && !check_repeated_keys(&child, error)) return false;
    return true;
}

bool json_parse(struct cJSON **root, const char *text, size_t length, struct error *error)
{
    struct json_node node;

    *root = NULL;
    if (!json_scan(text, length, error)) return false;
    *root = cJSON_ParseWithLengthOpts(text, length, NULL, false);
    if (!*root) {
        error_set(error, "out of memory");
        return false;
    }
    node = json_node_root(*root);
    if (check_repeated_keys(&node, error)) return true;
    cJSON_Delete(*root);
    *root = NULL;
    return false;
}

void json_delete(struct cJSON *root)
{
    cJSON_Delete(root);
}

struct json_node json_node_root(const struct cJSON *root)
{
    return (struct json_node){.value = root};
}

struct json_node json_node_child(const struct json_node *object, const char *key)
{
    struct json_node child = {.parent = object, .key = key};

    if (cJSON_IsObject(object->value)) child.value = cJSON_GetObjectItemCaseSensitive(object->value, key);
    return child;
}

struct json_node json_node_element(const struct json_node *array, size_t index)
{
    struct json_node element = {.parent = array, .index = index};

    if (cJSON_IsArray(array->value)) {
        element.value = array->value->child;
        for (size_t i = 0; i < index && element.value; i++)
            element.value = element.value->next;
    }
    return element;
}

size_t json_node_count(const struct json_node *node)
{
    size_t count = 0;

    if (!cJSON_IsArray(node->value) && !cJSON_IsObject(node->value)) return 0;
    for (const cJSON *child = node->value->child; child; child = child->next)
        count++;
    return count;
}

bool json_node_next(const struct json_node *parent, struct json_node *child)
{
    bool is_first = !child->value;
    const cJSON *value;

    if (!cJSON_IsArray(parent->value) && !cJSON_IsObject(parent->value)) return false;
    value = is_first ? parent->value->child : child->value->next;
    if (!value) return false;
    *child = (struct json_node){
        .value = value, .parent = parent, .key = value->string, .index = is_first ? 0 : child->index + 1};
    return true;
}

enum json_type json_node_type(const struct json_node *node)
{
    if (!node->value) return JSON_ABSENT;
    if (cJSON_IsObject(node->value)) return JSON_OBJECT;
    if (cJSON_IsArray(node->value)) return JSON_ARRAY;
    if (cJSON_IsString(node->value)) return JSON_STRING;
    if (cJSON_IsNumber(node->value)) return JSON_NUMBER;
    return cJSON_IsBool(node->value) ? JSON_BOOL : JSON_NULL;
}

bool json_node_is_absent(const struct json_node *node)
{
    return !node->value;
}

static bool is_plain_key(const char *key)
{
    size_t length = strlen(key);

    return length > 0 && length <= SHOWN_BYTES &&
           strspn(key, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") == length;
}

// `text` in quotes, shortened, with nothing in it that a terminal obeys.
static void append_shown_string(struct json_writer *writer, const char *text)
{
    size_t length, shown;
    char *prefix;

    assert(text);
    length = strlen(text);
    shown = utf8_prefix_length(text, length, SHOWN_BYTES);
    prefix = xasprintf("%.*s%s", (int)shown, text, shown < length ? "..." : "");

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

// What the value is, in a few words; owned by the caller.
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
        return json_format(node);
    }
}

bool json_fail_expected(const struct json_node *node, struct error *error, const char *expected)
{
    char *got = describe_value(node);

    json_fail(node, error, "expected %s, got %s", expected, got);
    free(got);
    return false;
}

static bool fail_range(const struct json_node *node, struct error *error, const char *kind, double min, double max)
{
    char expected[128];

    if (isinf(min) && isinf(max))
        snprintf(expected, sizeof expected, "%s", kind);
    else if (isinf(max))
        snprintf(expected, sizeof expected, "%s of at least %.15g", kind, min);
    else if (isinf(min))
        snprintf(expected, sizeof expected, "%s of at most %.15g", kind, max);
    else
        snprintf(expected, sizeof expected, "%s from %.15g to %.15g", kind, min, max);
    return json_fail_expected(node, error, expected);
}

bool json_read_number(const struct json_node *node, double min, double max, double *number, struct error *error)
{
    double value;

    if (!cJSON_IsNumber(node->value)) return fail_range(node, error, "a number", min, max);
    value = node->value->valuedouble;
    if (!(value >= min && value <= max)) return fail_range(node, error, "a number", min, max);
    *number = value;
    return true;
}

bool json_read_integer(const struct json_node *node, int64_t min, int64_t max, int64_t *integer, struct error *error)
{
    static const double exact_limit = 9007199254740992.0;
    double value = cJSON_IsNumber(node->value) ? node->value->valuedouble : (double)NAN;

    if (!(fabs(value) <= exact_limit) || value != rint(value) || (int64_t)value < min || (int64_t)value > max)
        return fail_range(node, error, "an integer", min == INT64_MIN ? -(double)INFINITY : (double)min,
                          max == INT64_MAX ? (double)INFINITY : (double)max);
    *integer = (int64_t)value;
    return true;
}

bool json_read_bool(const struct json_node *node, bool *value, struct error *error)
{
    if (!cJSON_IsBool(node->value)) return json_fail_expected(node, error, "true or false");
    *value = cJSON_IsTrue(node->value);
    return true;
}

bool json_read_string(const struct json_node *node, const char **text, struct error *error)
{
    if (!cJSON_IsString(node->value)) return json_fail_expected(node, error, "a string");
    *text = node->value->valuestring;
    return true;
}

bool json_read_enum(const struct json_node *node, const char *const names[], int *choice, struct error *error)
{
    struct json_writer expected = {0};
    const char *text = cJSON_IsString(node->value) ? node->value->valuestring : NULL;
    const char *nearest = text ? json_nearest_name(text, names) : NULL;
    char *got = NULL;

    for (int i = 0; names[i]; i++) {
        if (text && strcmp(text, names[i]) == 0) {
            *choice = i;
            json_writer_finish(&expected);
            return true;
        }
        json_write_string(&expected, names[i]);
    }
    got = describe_value(node);
    json_fail(node, error, "expected one of %s, got %s%s%s%s", expected.text ? expected.text : "nothing", got,
              nearest ? ", did you mean \"" : "", nearest ? nearest : "", nearest ? "\"?" : "");
    free(got);
    json_writer_finish(&expected);
    return false;
}

bool json_check_object(const struct json_node *node, struct error *error)
{
    return cJSON_IsObject(node->value) || json_fail_expected(node, error, "an object");
}

bool json_check_array(const struct json_node *node, size_t min_count, size_t max_count, struct error *error)
{
    char expected[96];
    size_t count = json_node_count(node);

    if (cJSON_IsArray(node->value) && count >= min_count && count <= max_count) return true;
    if (min_count == max_count)
        snprintf(expected, sizeof expected, "an array of %zu", min_count);
    else if (max_count == SIZE_MAX)
        snprintf(expected, sizeof expected, min_count > 0 ? "an array of at least %zu" : "an array", min_count);
    else
        snprintf(expected, sizeof expected, "an array of %zu to %zu", min_count, max_count);
    return json_fail_expected(node, error, expected);
}

// What an object is goes with the key, for another kind may have it.
static bool fail_unknown_key(const struct json_node *object, const char *key, const char *const names[],
                             struct error *error)
{
    struct json_node kind = json_node_child(object, "kind"), method = json_node_child(object, "method");
    const struct json_node *choice = cJSON_IsString(kind.value) ? &kind : &method;
    const char *chosen_text = cJSON_GetStringValue(choice->value);
    const char *nearest = json_nearest_name(key, names);
    struct json_writer shown = {0}, chosen = {0};

    append_shown_string(&shown, key);
    if (chosen_text) append_shown_string(&chosen, chosen_text);
    if (nearest)
        json_fail(object, error, "unknown key %s, did you mean \"%s\"?", shown.text, nearest);
    else if (chosen.text && strcmp(key, choice->key) != 0)
        json_fail(object, error, "unknown key %s beside %s %s", shown.text, choice->key, chosen.text);
    else
        json_fail(object, error, "unknown key %s", shown.text);
    json_writer_finish(&shown);
    json_writer_finish(&chosen);
    return false;
}

bool json_check_keys(const struct json_node *object, const char *const names[], struct error *error)
{
    struct json_node member = {0};

    while (json_node_next(object, &member)) {
        size_t i = 0;

        while (names[i] && strcmp(names[i], member.key) != 0)
            i++;
        if (!names[i]) return fail_unknown_key(object, member.key, names, error);
    }
    return true;
}

static void write_node(struct json_writer *writer, const struct json_node *node)
{
    enum json_type type = json_node_type(node);
    struct json_node child = {0};

    switch (type) {
    case JSON_NUMBER:
        json_write_number(writer, node->value->valuedouble);
        break;
    case JSON_STRING:
        json_write_string(writer, node->value->valuestring);
        break;
    case JSON_BOOL:
        json_write_bool(writer, cJSON_IsTrue(node->value));
        break;
    case JSON_ARRAY:
    case JSON_OBJECT:
        type == JSON_ARRAY ? json_write_begin_array(writer) : json_write_begin_object(writer);
        while (json_node_next(node, &child)) {
            if (child.key) json_write_key(writer, child.key);
            write_node(writer, &child);
        }
        type == JSON_ARRAY ? json_write_end_array(writer) : json_write_end_object(writer);
        break;
    default:
        json_write_null(writer);
    }
}

char *json_format(const struct json_node *node)
{
    struct json_writer writer = {0};

    write_node(&writer, node);
    return writer.text;
}

static size_t min3(size_t a, size_t b, size_t c)
{
    size_t ab = a < b ? a : b;

    return ab < c ? ab : c;
}

// Insertions, deletions, substitutions and swaps of neighbours, upper and lower case being one, that lead from `a` to `b`, each at most NAME_LIMIT long.
enum { NAME_LIMIT = 48 };

static size_t edit_distance(const char *a, const char *b)
{
    size_t rows[3][NAME_LIMIT + 1];
    size_t a_length = strlen(a), b_length = strlen(b);
    size_t *before = rows[0], *previous = rows[1], *current = rows[2];

    for (size_t j = 0; j <= b_length; j++)
        previous[j] = j;
    for (size_t i = 1; i <= a_length; i++) {
        size_t *recycled = before;

        current[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            bool differs = tolower((unsigned char)a[i - 1]) != tolower((unsigned char)b[j - 1]);
            bool is_swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];

            current[j] = min3(previous[j] + 1, current[j - 1] + 1, previous[j - 1] + differs);
            if (is_swap && before[j - 2] + 1 < current[j]) current[j] = before[j - 2] + 1;
        }
        before = previous;
        previous = current;
        current = recycled;
    }
    return previous[b_length];
}

const char *json_nearest_name(const char *text, const char *const names[])
{
    const char *nearest = NULL;
    size_t length = strlen(text);
    size_t limit = length < 4 ? 1 : 1 + length / 3;

    if (length == 0 || length > NAME_LIMIT) return NULL;
    for (size_t i = 0; names[i]; i++) {
        size_t distance;

        if (strlen(names[i]) > NAME_LIMIT) continue;
        distance = edit_distance(text, names[i]);
        if (distance <= limit && distance < strlen(names[i])) {
            nearest = names[i];
            limit = distance - (distance > 0);
            if (distance == 0) break;
        }
    }
    return nearest;
}
