// Reads JSON of unknown origin: every failure names the place ("scene.media[0].phase[0].g: expected ...").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cJSON;
struct error;

enum {
    JSON_DEPTH_LIMIT = 32,
    JSON_VALUE_LIMIT = 1000 * 1000, // values in a text, each some 100 bytes of memory
    JSON_NUMBER_SIZE = 64           // a number's characters and a NUL
};

enum json_type {
    JSON_ABSENT, // a node that json_node_child did not find
    JSON_NULL,
    JSON_BOOL,
    JSON_NUMBER,
    JSON_STRING,
    JSON_ARRAY,
    JSON_OBJECT
};

// A value and how it was reached. Lives on the reader's stack; `parent` must outlive it.
struct json_node {
    const struct cJSON *value;      // borrowed from the document; NULL when absent
    const struct json_node *parent; // NULL for the root
    const char *key;                // in an object; NULL in an array
    size_t index;                   // in an array
};

// Strict JSON: one value, nothing after it, at most JSON_DEPTH_LIMIT deep, no key twice in an object, finite numbers,
// no NUL in strings. The message names line and column of a syntax error, the path of a key that appears twice. Free with
// json_delete.
bool json_parse(struct cJSON **root, const char *text, size_t length, struct error *error);
void json_delete(struct cJSON *root); // accepts NULL

struct json_node json_node_root(const struct cJSON *root);
// A missing child (or a child of a node that is no object or array) is a node of type JSON_ABSENT.
struct json_node json_node_child(const struct json_node *object, const char *key);
struct json_node json_node_element(const struct json_node *array, size_t index);
size_t json_node_count(const struct json_node *node); // of an array's elements or an object's members, else 0
// Walks an array or object in order in linear time: start with child = {0}; false at the end.
bool json_node_next(const struct json_node *parent, struct json_node *child);
enum json_type json_node_type(const struct json_node *node);
bool json_node_is_absent(const struct json_node *node);

// Sets "PATH: message" and returns false; the path of the root is "job" or whatever `key` the root has, else nothing.
bool json_fail(const struct json_node *node, struct error *error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// "expected WHAT, got ..." with the value (shortened) or "nothing".
bool json_fail_expected(const struct json_node *node, struct error *error, const char *expected);

// Readers check type and range; the range is closed. An absent node is an error: ask json_node_is_absent first.
bool json_read_number(const struct json_node *node, double min, double max, double *number, struct error *error);
// Integers beyond 2^53 either way are refused: not every one of them survives the way through a double.
bool json_read_integer(const struct json_node *node, int64_t min, int64_t max, int64_t *integer, struct error *error);
bool json_read_bool(const struct json_node *node, bool *value, struct error *error);
bool json_read_string(const struct json_node *node, const char **text, struct error *error); // borrowed
// `names` ends in NULL; `*choice` receives the index. The message lists the names and the nearest one.
bool json_read_enum(const struct json_node *node, const char *const names[], int *choice, struct error *error);
bool json_check_object(const struct json_node *node, struct error *error);
bool json_check_array(const struct json_node *node, size_t min_count, size_t max_count, struct error *error);
// Refuses keys that `names` (ends in NULL) lacks: `unknown key "x", did you mean "y"?`, where no name is near
// `unknown key "x" beside kind "z"` in an object that has a `kind` or a `method`.
bool json_check_keys(const struct json_node *object, const char *const names[], struct error *error);

// The value as compact JSON; owned by the caller.
char *json_format(const struct json_node *node);

// The name of `names` (ends in NULL) nearest to `text`, upper or lower case, or NULL when none is near.
const char *json_nearest_name(const char *text, const char *const names[]);
