// Roughly how deep places lie behind media whose density varies, as lamps see them.
// SPDX-License-Identifier: Apache-2.0
// It tells where paths look for a lamp, never how much light there is: few cells and one density in each will do.
#pragma once

#include "reference/still.h"

#include <stddef.h>

// Even cells of a box about those media. The zero value has none.
struct path_depth {
    struct vec3 low;
    double side[3]; // of a cell, m
    float *depths;  // owned; optical depths from the cells' middles, x fastest, lamp after lamp; NULL: none
};

// Lamps are the still's lights, and its spheres after them. The caller passes it to path_depth_finish.
void path_depth_init(struct path_depth *depth, const struct still *still);
void path_depth_finish(struct path_depth *depth);
// 0 outside of the box.
double path_depth_at(const struct path_depth *depth, size_t lamp, struct vec3 position);
