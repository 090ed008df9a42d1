// A grid that shows errors of orientation: soft lobes without symmetry under mirroring or exchange of axes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Writes an NRRD file of float voxels from 0 to 1 with its middle at the origin; 0 in more than half of its box. `axes`
// is the header's line "space directions: (x,y,z) (x,y,z) (x,y,z)\n".
void lobes_write(const char *path, const int size[3], const char *axes);
