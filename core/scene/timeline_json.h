// Reads a number or a vector that may move.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/json/json_read.h"
#include "core/scene/timeline.h"

#include <stdbool.h>

// The allowed values of a timeline. Every component must stay within [min, max] throughout `span`.
struct timeline_limits {
    int components; // 1 a number, 3 a vector, 0 either (a number or [r, g, b])
    double min, max;
    bool excludes_min, excludes_max;
    bool is_position;  // an orbit may drive it
    bool is_direction; // the zero vector is refused
    struct timeline_span span;
};

enum { TIMELINE_KEY_LIMIT = 10000 };

// On failure `timeline` is empty.
bool timeline_from_json(struct timeline *timeline, const struct json_node *node, const struct timeline_limits *limits,
                        struct error *error);
