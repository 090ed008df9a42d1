// SPDX-License-Identifier: Apache-2.0
#include "worker/render/tile_rows.h"

#include "core/job/job.h"

enum {
    SMALLEST = 8,
    GRAIN = 64, // software GL divides its work among threads in squares of this side
    GROWTH_LIMIT = 8,
    SQUARES_LIMIT = 1 << 20
};

static int scale(int count, double seconds)
{
    double factor = TILE_ROWS_SECONDS / (seconds > 1e-6 ? seconds : 1e-6);

    return (int)(count * (factor < GROWTH_LIMIT ? factor : GROWTH_LIMIT));
}

int tile_squares_next(int squares, double seconds)
{
    int next = scale(squares, seconds);

    if (next < 1) next = 1;
    return next < SQUARES_LIMIT ? next : SQUARES_LIMIT;
}

int tile_rows_next(int rows, double seconds)
{
    int next = scale(rows, seconds);

    if (next > GRAIN) next -= next % GRAIN;
    if (next < SMALLEST) next = SMALLEST;
    return next < JOB_RESOLUTION_LIMIT ? next : JOB_RESOLUTION_LIMIT;
}
