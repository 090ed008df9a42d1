// How random paths of pixels tell the steps that they took.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum {
    WALK_COUNT_BUFFER = 2, // the unit of the storage buffer that holds one number,
    WALK_COUNT_STEPS = 16  // in which so many steps count as one
};
