// Random directions of scattering.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/medium.h"
#include "reference/stream.h"

// A direction of length 1 whose cosine to `axis`, of length 1, is `cosine`; all turns about the axis are alike.
struct vec3 phase_draw_about(struct vec3 axis, double cosine, struct stream *stream);
// The cosine between the directions of travel before and after, as medium_phase weighs it: Henyey and Greenstein's by
// Witt, Astrophysical Journal Supplement 35, 1977; Rayleigh's by Frisvad, Journal of the Optical Society of America A
// 28, 2011.
double phase_draw_cosine(const struct medium *medium, struct stream *stream);
