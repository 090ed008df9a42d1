// A lattice of pixels fed with a picture that is known at every point.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/picture/image.h"
#include "worker/pixels/pixel_guard.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// What a point shows. Points lie up to a stride beyond the picture.
struct lattice_point {
    float rgba[4], transmittance[4], paths[4], depth;
    uint32_t signature;
};

typedef struct lattice_point lattice_picture(const void *user, int x, int y);

struct lattice_case {
    int width_px, height_px, stride;
    double threshold;
    const struct pixel_guard *guards;
    size_t guard_count;
    bool is_colour_only; // no transmittance, depth and paths
    lattice_picture *picture;
    const void *user;
};

struct lattice_made {
    struct image image;
    float *paths;         // 4 a pixel; NULL where there are none
    uint32_t *signatures; // 1 a pixel
    size_t traced;
    size_t first_wanted; // on the first level that is refined
};

// Refines to the end. Fails the test where a point is wanted twice, off its level or beyond the picture by a stride.
struct lattice_made lattice_make(const struct lattice_case *of);
void lattice_made_finish(struct lattice_made *made);
// Fails the test unless `traced` and the image's doubts agree, and each traced pixel has the picture's bits in all
// channels.
void lattice_check_traced(const struct lattice_case *of, const struct lattice_made *made);
// The largest difference from the picture in colours and alpha.
double lattice_find_error(const struct lattice_case *of, const struct lattice_made *made);
