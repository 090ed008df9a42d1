// The two layers of a frame by random paths.
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
