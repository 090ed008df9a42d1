// Which pixels of a frame are traced, and what the others show: a lattice, refined where the picture asks for it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/picture/pixel.h"
#include "worker/pixels/pixel_planes.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct image;
struct pixel_guard;
struct voxel_guards;

struct pixel_lattice_params {
    // Its rgba, transmittance and depth are filled, and it gets `doubts`. Borrowed; outlives the lattice.
    struct image *image;
    int stride;       // px, of the first level: a power of two, at least 2
    double threshold; // a pixel is traced where the picture bends more (pixel_spread.h): colours relative to the RMS of
                      // the picture, alpha and transmittance as they are
    bool has_paths;
    bool has_noise;                   // the light is random, and its transmittance tells how (pixel_noise.h)
    bool has_edges;                   // signatures are kept at stride 1, for pixel_edges_find
    const struct pixel_guard *guards; // borrowed; outlive the lattice
    size_t guard_count;
    const struct voxel_guards *voxels; // borrowed; outlive the lattice; NULL: none
};

// A point that was traced at this level, and the doubt that its error leaves about those around it.
struct pixel_surprise {
    uint32_t place;
    float doubt;
};

// A level: each `stride`-th pixel of each `stride`-th row, and the points after the last of them which are needed to
// interpolate up to the picture's edge. Those lie beyond it, by less than a stride.
struct pixel_lattice {
    struct pixel_lattice_params params;
    int stride, columns, rows;
    struct pixel_planes planes; // owned, except those of the image at stride 1
    uint8_t *forced; // owned: by pixel_guard_mark and voxel_guards_mark; NULL where there are no guards, and at first
    uint8_t *doubts; // owned: 0: traced; else how doubtful the interpolation is, 255: as much as may be
    uint8_t *roughness; // owned: as pixel_calm_params has it; NULL at stride 1
    double rms;         // of the colours of the first level
    size_t traced;      // pixels of the picture that were traced, or are wanted
    // Points that are to be traced, in the order of rows, and where they are in `planes`. Owned.
    struct pixel *wanted;
    uint32_t *places;
    size_t wanted_count, wanted_capacity, place_capacity;
    struct pixel_surprise *surprises; // owned; by place
    size_t surprise_count;
};

// Wants all points of the first level.
void pixel_lattice_init(struct pixel_lattice *lattice, const struct pixel_lattice_params *params);
void pixel_lattice_finish(struct pixel_lattice *lattice);
// Adds a point of the picture, or one beyond its edge, to those that are wanted; `place` is its place in `planes`.
void pixel_lattice_want(struct pixel_lattice *lattice, struct pixel pixel, size_t place);
// Takes what the wanted points show, in their order.
void pixel_lattice_give(struct pixel_lattice *lattice, const struct pixel_planes *traced);
// Goes on to half the stride, and finds what is wanted there, which may be nothing. False at stride 1: the image is
// whole.
//
// A point is traced where the interpolation is doubtful at it or at one of the points up to two away, where the points
// that it lies between differ in their signature or by a fiftieth of their depth, and where a guard asks for it; one of
// the level before that was interpolated there where its interpolation is doubtful on this one. All others are
// interpolated: colours, alpha and transmittance as in pixel_spread.h, depth and paths linearly. Where the picture is
// calm (pixel_calm.h) no ray is asked for, so all is interpolated linearly there. Adaptive
// refinement in the image plane: M. Levoy, Volume rendering by adaptive refinement, The Visual Computer 6(1), 1990.
bool pixel_lattice_refine(struct pixel_lattice *lattice);
