// How many rows of a picture are drawn at once: as many as take a moment, so that frames can be stopped and drivers stay alive.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum { TILE_ROWS_FIRST = 32 };

#define TILE_ROWS_SECONDS 0.35 // that a tile should take

// After `rows` of them took `seconds`.
int tile_rows_next(int rows, double seconds);
