// Random jobs: every kind of medium, bounds, light and camera.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct random_job {
    const char *volume; // a file of voxels, as random_job_write_volume writes it
    uint64_t seed;
    const char *quality; // JSON
    int width_px, height_px;
};

// The document, owned by the caller: one frame, 0, as half floats.
char *random_job_write(const struct random_job *params);
// 6 x 5 x 4 float voxels about 0.2 m apart, along oblique axes.
void random_job_write_volume(const char *path);
