// Finds light that is not finite before a job is rendered, and the line of the user's code that it comes from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/picture/pixel.h"
#include "worker/render/renderer.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct image;
struct job;
struct plan_params;

// The index of an image's first pixel that has a colour which is not finite; false: all are finite.
bool finite_check_find(const struct image *image, size_t *index);

// Renders a few pixels of a frame of the job, which is of no method auto. False: one is not finite, or it was stopped;
// then the fault and the error say why. Other faults of these pixels are left for the frame to meet.
bool finite_check_frame(const struct plan_params *params, int32_t frame, enum renderer_fault *fault,
                        struct error *error);

// Says that a pixel's light is not finite, and why. The code of each density in GLSL is tried with its first statements
// guarded: the fewest that make the pixel finite name the line. Renders the pixel some ten times, with the job's
// quality, which is of no method auto.
void finite_check_tell(struct renderer *renderer, const struct job *job, int32_t frame, struct pixel pixel,
                       struct error *error);

// Checks a whole frame that was rendered with the job's quality. A pixel whose light is not finite is told as above. A
// value that is finite and too large for the job's half is told as image_is_finite tells it: no code is at fault there.
bool finite_check_picture(struct renderer *renderer, const struct job *job, int32_t frame, const struct image *image,
                          struct error *error);
