// Finds light that is not finite before a job is rendered, and the line of the user's code that it comes from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/picture/pixel.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct image;
struct job;
struct renderer;

// The index of an image's first pixel that has a colour which is not finite; false: all are finite.
bool finite_check_find(const struct image *image, size_t *index);

// Says that a pixel's light is not finite, and why. The code of each density in GLSL is tried with its first statements
// guarded: the fewest that make the pixel finite name the line. Renders the pixel some ten times, with the job's
// quality, which is of no method auto.
void finite_check_tell(struct renderer *renderer, const struct job *job, int32_t frame, struct pixel pixel,
                       struct error *error);
