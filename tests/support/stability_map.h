// The sweeps as text, as a table and as a picture: what docs/stability.md shows.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct gl_context;

// `form`: "points", "map" (Markdown) or "svg"; `slug`: of one sweep, NULL of all. To stdout; false when something
// cannot be measured.
bool stability_map_print(struct gl_context *context, const char *form, const char *slug);
