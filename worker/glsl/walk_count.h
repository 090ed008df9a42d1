// How random paths of pixels tell, in a storage buffer of two numbers, the steps that they took, and how far they are.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum {
    WALK_COUNT_BUFFER = 2,  // its unit
    WALK_COUNT_STEPS = 16,  // that count as one in the first number
    WALK_COUNT_SHARES = 256 // in the second one, of a pixel whose paths are all over
};
