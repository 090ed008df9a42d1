// How much of a picture is drawn at once: so little that frames can be stopped and drivers do not time out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

enum { TILE_ROWS_FIRST = 32, TILE_SQUARES_FIRST = 16 };

#define TILE_ROWS_SECONDS 0.35 // the time that a tile should take

// Returns the next number of rows, after `rows` took `seconds`.
int tile_rows_next(int rows, double seconds);
// The same for squares of a list of pixels.
int tile_squares_next(int squares, double seconds);
