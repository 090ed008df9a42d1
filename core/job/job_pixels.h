// Whether pixels of a job's frames may be interpolated.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

// What of a scene by that method has random numbers of its own in each pixel: interpolation would pass its noise off as
// smoothness. NULL: nothing; pixels can be interpolated.
const char *job_pixels_obstacle(const struct scene *scene, enum job_method method);
