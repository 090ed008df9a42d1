// Reads members of a scene's JSON objects: numbers and vectors that may move, with limits that several of them share.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"
#include "core/scene/timeline_json.h"

#include <stdbool.h>

struct error;

// The object that is read, and values for the whole document.
struct scene_reader {
    const struct json_node *object; // borrowed; outlives the reader
    struct timeline_span span;      // the times at which values are checked
    struct error *error;
};

extern const struct timeline_limits SCENE_POSITION;  // m
extern const struct timeline_limits SCENE_DIRECTION; // any length but 0
extern const struct timeline_limits SCENE_LENGTH;    // m, >= 0
extern const struct timeline_limits SCENE_SIZE;      // m, > 0
extern const struct timeline_limits SCENE_SIDES;     // of a box, m, > 0
extern const struct timeline_limits SCENE_ANGLE;
extern const struct timeline_limits SCENE_SCALE;    // >= 0
extern const struct timeline_limits SCENE_SHARE;    // [0, 1]
extern const struct timeline_limits SCENE_RADIANCE; // a number or a colour, >= 0

bool scene_reader_has_key(const struct scene_reader *reader, const char *key);
bool scene_reader_read(const struct scene_reader *reader, const char *key, const struct timeline_limits *limits,
                       struct timeline *timeline);
// An absent key gives `fallback` in each component; where a number or a colour is allowed, a number.
bool scene_reader_read_or(const struct scene_reader *reader, const char *key, const struct timeline_limits *limits,
                          double fallback, struct timeline *timeline);
// An absent key gives [0, 1, 0].
bool scene_reader_read_direction(const struct scene_reader *reader, const char *key, struct timeline *timeline);
// An absent key leaves `*choice` unchanged.
bool scene_reader_read_choice(const struct scene_reader *reader, const char *key, const char *const names[],
                              int *choice);
// Reads the key "file", the path of a file with one of these contents (enum file_content); owned by the caller.
bool scene_reader_read_file(const struct scene_reader *reader, unsigned contents, char **path);
// Reads the key "grid", the name of a grid in a file; owned by the caller, NULL on failure.
bool scene_reader_read_grid_name(const struct scene_reader *reader, char **name);
