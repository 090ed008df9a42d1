// Reads JSON of unknown origin: every failure names the place ("scene.media[0].phase[0].g: expected ...").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_fail.h"
#include "core/json/json_node.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cJSON;
struct error;

// Strict JSON: one value, nothing after it, within the limits of json_scan.h, no key twice in an object, finite
// numbers, no NUL in strings. The message names line and column of a syntax error, the path of a key that appears
// twice. `*root` is freed with json_delete.
bool json_parse(struct cJSON **root, const char *text, size_t length, struct error *error);
void json_delete(struct cJSON *root); // accepts NULL

// Readers check type and range; the range is closed. An absent node is an error: ask json_node_is_absent first.
bool json_read_number(const struct json_node *node, double min, double max, double *number, struct error *error);
// Integers beyond 2^53 either way are refused: a double does not hold all of them.
bool json_read_integer(const struct json_node *node, int64_t min, int64_t max, int64_t *integer, struct error *error);
bool json_read_bool(const struct json_node *node, bool *value, struct error *error);
bool json_read_string(const struct json_node *node, const char **text, struct error *error); // borrowed
// `names` ends in NULL; `*choice` receives the index.
bool json_read_enum(const struct json_node *node, const char *const names[], int *choice, struct error *error);
bool json_check_object(const struct json_node *node, struct error *error);
bool json_check_array(const struct json_node *node, size_t min_count, size_t max_count, struct error *error);
// Refuses keys that `names` (ends in NULL) lacks.
bool json_check_keys(const struct json_node *object, const char *const names[], struct error *error);
