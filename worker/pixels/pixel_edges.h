// Pixels whose centre does not stand for all of their samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

struct pixel_lattice;

// Wants the pixels of a picture of centres, which is whole, that are to have all of their samples: those which a guard
// asks for, those beside a pixel of another signature, and those at which the second difference of some value along a
// row or column is over twice the threshold. Elsewhere a pixel's mean is within a sixth of the threshold of its centre,
// if the picture is as smooth between the centres; such pixels count as interpolated, and get a doubt. Returns the
// number of wanted pixels.
size_t pixel_edges_find(struct pixel_lattice *lattice);
