// Job documents for tests to start from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

// jobs/NAME, owned by the caller.
char *job_text_load(const char *name);

// A job that uses every key of camera, lights and output, the fold fractal, and every way to move a value at least
// once.
extern const char job_text_full[];
// Jobs that use every key of the other densities, of bounds, and of the methods.
extern const char job_text_noise[];
extern const char job_text_fog[];
extern const char job_text_grid[];
extern const char job_text_glsl[];
// One that uses every key of scattering, of the lights that a march alone does not show, and of random paths.
extern const char job_text_paths[];
// One that uses every key of objects, materials and textures, and has interiors.
extern const char job_text_objects[];
