// SPDX-License-Identifier: Apache-2.0
#include "core/json/json_read.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_scan.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int compare_keys(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

// A key that appears twice in `object`, or NULL.
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
    const char *text = cJSON_GetStringValue(node->value);

    for (int i = 0; text && names[i]; i++) {
        if (strcmp(text, names[i]) != 0) continue;
        *choice = i;
        return true;
    }
    return json_fail_choice(node, error, names);
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

bool json_check_keys(const struct json_node *object, const char *const names[], struct error *error)
{
    struct json_node member = {0};

    while (json_node_next(object, &member)) {
        size_t i = 0;

        while (names[i] && strcmp(names[i], member.key) != 0)
            i++;
        if (!names[i]) return json_fail_key(object, error, member.key, names);
    }
    return true;
}
