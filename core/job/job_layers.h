// The layers of a frame that is rendered as a sum of several.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

#include <stdbool.h>

// True where a job's frames are the sum of two layers: what camera rays meet without scattering, which a march shows
// without noise, and the light that was scattered, along random paths. Where pixels are interpolated, each layer is as
// it bends. A march needs a step where density varies, and paths of every pixel do without it: then they estimate what
// is seen as well.
bool job_layers_are_two(const struct job *job);
// The jobs of the layers: shallow copies, never finished.
//
// What is seen directly: what media emit along camera rays, what lies behind them, alpha, transmittance and depth.
struct job job_layers_seen(const struct job *job);
// Light that was scattered, as color alone. In place of transmittance it has by how much the mean of a pixel's paths
// and that of the first half of them differ: a draw from the distribution of its noise.
struct job job_layers_scattered(const struct job *job);

// True where some pixels of a march are interpolated before a dome that is seen: what media let pass is smooth, and a
// sky need not be.
bool job_layers_have_sky(const struct job *job);
// The jobs of these layers: shallow copies, never finished.
//
// All but the dome, which lights media and is not seen. It has transmittance.
struct job job_layers_lit(const struct job *job);
// The dome as if nothing were before it, in every pixel.
struct job job_layers_sky(const struct job *job);
