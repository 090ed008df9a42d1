// The scenes of the stability map, as jobs and as files of voxels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/still.h"

#include <stddef.h>

struct stability_method;
struct stability_sweep;

// Odd, so that one ray goes through the middle.
enum { STABILITY_WIDTH_PX = 13, STABILITY_HEIGHT_PX = 9 };

// A job with a frame for each of `values`, owned by the caller; sweeps that are apart take one. `folder` is where
// stability_scene_write_voxels put its file.
char *stability_scene_write(const struct stability_sweep *sweep, const struct stability_method *method,
                            const double *values, size_t count, const char *folder);
// What a sweep of voxels reads at `value`; nothing for others.
void stability_scene_write_voxels(const struct stability_sweep *sweep, double value, const char *folder);
// The twin of a sweep's code; NULL: it has none.
density_function_at *stability_scene_twin(const struct stability_sweep *sweep);
