// The rules of each kind of light in a job: its name, how it is read, where its light comes from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

#include <stdbool.h>

struct scene_reader;

// A new kind is a row in light_rules.c. What it does not have is 0.
struct light_rules {
    const char *name;   // in the job
    const char *noun;   // in sentences: "a sun"
    bool has_position;  // its light comes from there; else it is parallel
    bool has_size;      // its light comes from many directions: no march shows it
    bool has_direction; // in which it shines, of any length but 0
    // `reader` stands at the light, of which only the kind is set. On failure the caller still calls scene_finish.
    bool (*read)(const struct scene_reader *reader, struct scene_light *light);
};

const struct light_rules *light_rules_of(enum scene_light_kind kind);

enum { LIGHT_RULES_LIMIT = 16 };
// The names of all kinds in the order of enum scene_light_kind, then NULL.
void light_rules_list(const char *names[static LIGHT_RULES_LIMIT]);
