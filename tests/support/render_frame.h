// Renders one frame for a test on a context of its own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/gl/gl_context.h"

struct image;
struct job;
struct ray_counts;

// Frame 0 in software, with depth and transmittance; a failure fails the test. The caller finishes the image.
void render_frame_zero(const struct job *job, struct image *image);
// The same on any backend; one that is not there skips the test.
void render_frame_on(enum gl_backend backend, const struct job *job, struct image *image);
void render_frame_counting_rays(enum gl_backend backend, const struct job *job, struct image *image,
                                struct ray_counts *counts);
