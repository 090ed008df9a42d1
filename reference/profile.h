// What a straight ray crosses: densities, optical depth and emitted light along it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/kronrod.h"
#include "reference/still.h"

#include <stdbool.h>

// The optical depth of a visible cell at most: in a deeper one every node may lie behind the bright front.
static const double PROFILE_THICKEST = 2.0;

struct profile_cell {
    double begin, end;                                 // m along the ray
    int halvings;                                      // of the span
    int node_count;                                    // GAUSS_NODES or KRONROD_NODES
    double density[KRONROD_NODES][SCENE_MEDIUM_LIMIT]; // of the profile's media
    double sigma_t[KRONROD_NODES][3], emission[KRONROD_NODES][3];
    double depth_before[3]; // optical depth from the ray's begin to the cell
    // Optical depth of the cell, and the radiance that it adds to a ray of throughput 1 at its begin.
    double optical_depth[3], emitted[3];
    double depth_error[3], emitted_error[3];
    double error; // relative to the ray's light
};

struct profile {
    const struct ray *ray;      // borrowed; outlives us
    struct still_media media;   // of the ray's region
    struct profile_cell *cells; // owned
    size_t count, capacity;
    double optical_depth[3], emitted[3]; // of the whole ray
    bool hit_limit;                      // a cell was not refined further
};

struct profile_accuracy {
    // Error of the optical depths where anything is visible; of the opacity and of the emitted light, each against
    // itself.
    double relative;
    double floor;      // less emitted light counts as this much
    int halving_limit; // of a span
};

// Refines cells until their estimated errors are within the accuracy. The cells are ascending; within each of `spans`
// all is smooth.
void profile_init(struct profile *profile, const struct ray *ray, struct still_media media,
                  const struct span_list *spans, const struct profile_accuracy *accuracy);
void profile_finish(struct profile *profile);

// True behind so much optical depth that nothing is visible.
bool profile_is_dark(const double optical_depth[static 3]);
double profile_distance(const struct profile_cell *cell, int node);           // m along the ray
double profile_depth(const struct profile_cell *cell, int node, int channel); // optical depth from the ray's begin

// Gives a cell all of Kronrod's nodes.
void profile_extend(struct profile *profile, size_t index);
// Halves a cell. The second half is appended, so pointers to cells become invalid. The ray's sums stay as they are.
void profile_halve(struct profile *profile, size_t index);
