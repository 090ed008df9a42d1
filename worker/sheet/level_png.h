// A PNG of a picture as far as it is known.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct picture_level;

// Replaces the file at `path`: a reader never meets half of one. Each pixel shows the point next to it, in sRGB over
// black, and the exposure is the one that exposure.h chooses for the points.
bool level_png_write(const char *path, const struct picture_level *level, struct error *error);
