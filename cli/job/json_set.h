// Changes one value of a JSON document by its path: "scene.media[0].sigma_s=32".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

// `assignment` is PATH=VALUE: keys joined by dots, elements as [N]. VALUE is JSON, or else a string; a number that
// replaces a string becomes a string, but where a job may have either (scene.scattering.orders). A missing key is
// added, an index equal to the array's count appends. Returns the whole edited document as compact JSON, owned by the
// caller; NULL on failure, with `error` naming the place.
char *json_set(const char *document, const char *assignment, struct error *error);
// Returns the document without the object's member at `path`, owned by the caller, and its value as JSON, likewise, in
// `*value` (may be NULL); NULL: there is none, and `*value` is as it was. An element of an array is no member.
char *json_take(const char *document, const char *path, char **value);
// Replaces `*document` by one whose value at `path` is the string `text`.
bool json_set_text(char **document, const char *path, const char *text, struct error *error);
