// Mistakes that a renderer could make, put into pictures on purpose.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct image;
struct job;

enum flaw { FLAW_NONE, FLAW_SPOT, FLAW_DIM, FLAW_CONSTANT, FLAW_LIGHT_MOVED, FLAW_LIGHT_GONE, FLAW_COARSE, FLAW_COUNT };

extern const char *const flaw_names[FLAW_COUNT];

// Spoils the values: two pixels of the brightest value, a region 20 % dim, or all 5 % bright; else nothing.
void flaw_spoil_values(enum flaw flaw, struct image *image);
// True for flaws of the scene's first light. `spoilt` is then a shallow copy of the job, never finished, whose light is
// 0.2 s late or has a quarter of its intensity.
bool flaw_spoil_light(enum flaw flaw, const struct job *job, int32_t frame, struct job *spoilt);
// Takes the values from a picture with a spoilt light, of the same size: all of a late one, a dim one's in a region.
void flaw_mix(enum flaw flaw, const struct image *spoilt, struct image *image);
