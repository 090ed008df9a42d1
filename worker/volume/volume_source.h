// Which file a volume is read from, and what the job says of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"

struct volume_source {
    const char *path;     // borrowed while volume_open runs
    struct scene_raw raw; // of a raw file; must be all zero for the others
    double spacing[3];    // m; overrides the file's: directions and the grid's middle stay. All 0: as the file says
};
