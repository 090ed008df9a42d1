// What is wrong with a JSON value, said with its place: "scene.media[0].phase[0].g: expected ...".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_node.h"

#include <stdbool.h>

struct error;

// All return false.
// "PATH: message". The path of the root is whatever `key` the root has, else nothing.
bool json_fail(const struct json_node *node, struct error *error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
// "expected WHAT, got ..." with the value (shortened) or "nothing".
bool json_fail_expected(const struct json_node *node, struct error *error, const char *expected);
// "expected one of ..." with `names` (ends in NULL) and the nearest of them.
bool json_fail_choice(const struct json_node *node, struct error *error, const char *const names[]);
// `unknown key "x", did you mean "y"?`. Where none of `names` (ends in NULL) is near, `unknown key "x"; known: a, b`,
// or, in an object that has a `kind` or a `method`, `unknown key "x" beside kind "z"; known: a, b`: another kind may
// have the key.
bool json_fail_key(const struct json_node *object, struct error *error, const char *key, const char *const names[]);
