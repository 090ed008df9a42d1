// A pixel of a frame, by its place.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct pixel {
    int x, y; // px, from the top left
};
