// Where a level of a lattice is so smooth that half its stride asks for no ray.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

struct pixel_planes;

// The largest roughness of a calm point: a sixteenth of that for which a point is traced. Half the stride quarters it.
enum { PIXEL_CALM_MOST = 16 };

// Cells of a row of a level: each is a point, and what lies between it, its right neighbour and the two below these.
struct pixel_run {
    int first, end; // the column after the last cell
};

struct pixel_calm_params {
    const struct pixel_planes *planes; // of the level; borrowed, as is what follows
    const uint8_t
        *roughness; // of each point: how much the picture bends there, as coded doubts are; 255: it was traced
                    // for that, or for what is not known from its neighbours
    int columns, rows;
    const uint8_t *forced; // of each point of the finer level, not 0: a guard asks for it; NULL: there are no guards
    int finer_columns, finer_rows;
};

// The cells of a row which are not calm. The zero value is empty.
struct pixel_calm {
    struct pixel_calm_params params;
    uint8_t *rough, *wide;  // owned: of a row of cells
    struct pixel_run *runs; // owned: in the order of columns, with calm cells between any two
    size_t run_count;
};

void pixel_calm_init(struct pixel_calm *calm, const struct pixel_calm_params *params);
void pixel_calm_finish(struct pixel_calm *calm);
// Finds `runs` of a row of the level. A cell is in none of them if the roughness of all points up to three away is at
// most PIXEL_CALM_MOST, its corners have one signature and, if any, one depth but for a fiftieth, and no guard asks for
// one of its points.
void pixel_calm_find(struct pixel_calm *calm, int row);
