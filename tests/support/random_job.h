// Random jobs: every kind of medium, bounds, light and camera.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct random_job {
    const char *volume; // a file of voxels, as random_job_write_volume writes it
    uint64_t seed;
    const char *quality; // JSON
    int width_px, height_px;
    // Light scatters more than once, from spots and domes too. Nothing is without an end, and a black light moves, so
    // that no two frames share their random numbers.
    bool scatters;
    bool has_solids; // (scatters) with lamps of a size and diffuse surfaces, which paths alone show
};

// The document, owned by the caller: one frame, 0, as half floats; frames 0 to 99 of light that scatters.
char *random_job_write(const struct random_job *params);
// 6 x 5 x 4 float voxels about 0.2 m apart, along oblique axes.
void random_job_write_volume(const char *path);
