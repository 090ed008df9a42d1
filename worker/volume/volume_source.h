// The file that a volume is read from, and what the job says about it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

struct volume_source {
    const char *path;     // borrowed while volume_open runs
    struct scene_raw raw; // for a raw file; all zero for the others
    double spacing[3]; // m; overrides the file's sides, keeps directions and the grid's middle; all 0: as in the file
};
