// Writes small EXR files for tests.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

// Writes an image of width x height pixels, 3 values each, rows from the top; fails the test when it cannot.
void exr_maker_write(const char *path, int width, int height, enum job_pixel pixel, const float *rgb);
