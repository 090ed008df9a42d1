// SPDX-License-Identifier: Apache-2.0
#include "worker/render/tile_rows.h"

#include "core/job/job.h"

enum {
    SMALLEST = 8,
    GRAIN = 64, // software GL divides its work among threads in squares of this side
    GROWTH_LIMIT = 8
};

int tile_rows_next(int rows, double seconds)
{
    double factor = TILE_ROWS_SECONDS / (seconds > 1e-6 ? seconds : 1e-6);
    int next = (int)(rows * (factor < GROWTH_LIMIT ? factor : GROWTH_LIMIT));

    if (next > GRAIN) next -= next % GRAIN;
    if (next < SMALLEST) next = SMALLEST;
    return next < JOB_RESOLUTION_LIMIT ? next : JOB_RESOLUTION_LIMIT;
}
