// SPDX-License-Identifier: Apache-2.0
#include "core/json/json_node.h"

#include "core/json/json_write.h"

#include <cjson/cJSON.h>

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

char *json_node_format(const struct json_node *node)
{
    struct json_writer writer = {0};

    write_node(&writer, node);
    return writer.text;
}
