// The picture of the seed's cloud shader, linear, in double precision: what jobs/cloud_seed.json must reproduce.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Fills `rgb` (3 * size_px * size_px values, first row on top) with a square picture at `time` seconds.
void seed_cloud_render(double time, int size_px, double *rgb);
