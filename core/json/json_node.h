// A value of a JSON document, and how it was reached.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct cJSON;

enum json_type {
    JSON_ABSENT, // a node that json_node_child did not find
    JSON_NULL,
    JSON_BOOL,
    JSON_NUMBER,
    JSON_STRING,
    JSON_ARRAY,
    JSON_OBJECT
};

// Lives on the reader's stack; `parent` must outlive it.
struct json_node {
    const struct cJSON *value;      // borrowed from the document; NULL when absent
    const struct json_node *parent; // NULL for the root
    const char *key;                // in an object; NULL in an array
    size_t index;                   // in an array
};

struct json_node json_node_root(const struct cJSON *root);
// A missing child (or a child of a node that is no object or array) is a node of type JSON_ABSENT.
struct json_node json_node_child(const struct json_node *object, const char *key);
struct json_node json_node_element(const struct json_node *array, size_t index);
size_t json_node_count(const struct json_node *node); // an array's elements or an object's members, else 0
// Walks an array or object in order in linear time: start with child = {0}; false at the end.
bool json_node_next(const struct json_node *parent, struct json_node *child);
enum json_type json_node_type(const struct json_node *node);
bool json_node_is_absent(const struct json_node *node);
char *json_node_format(const struct json_node *node); // compact JSON; owned by the caller
