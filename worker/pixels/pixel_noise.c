// SPDX-License-Identifier: Apache-2.0
#include "worker/pixels/pixel_noise.h"

#include "core/base/alloc.h"

#include <math.h>
#include <stdlib.h>

enum { REACH = 2 }; // of the points whose noise is taken together

// Of what noise explains. The standard deviation is an estimate, paths have more large values than a normal
// distribution, and a point has four bends, each of which would have 25 points traced: for a cloud of soft balls and
// 1024 paths three have 16 % of the pixels traced and leave 2.8e-2 of the light, five have 7 % and leave 2.6e-2.
static const float SIGMAS = 5.0f;
// Of a bend (a - 2 b + c) / 8 over that of a point.
static const float BEND = 0.306186f;
// Of the difference between a point and the mean of those around it, with weights of 9, 9, -1 and -1 sixteenths.
static const float DIFFERENCE = 1.28f;

static float largest(const float *noise)
{
    return fmaxf(fmaxf(noise[0], noise[1]), noise[2]);
}

static void sum_columns(const float *plane, int columns, int row, float *sums)
{
    const float *values = plane + 4 * (size_t)columns * (size_t)row;

    for (int x = 0; x < columns; x++)
        for (int c = 0; c < 3; c++) {
            double sum = 0.0;
            int count = 0;

            for (int at = x > REACH ? x - REACH : 0; at <= x + REACH && at < columns; at++, count++)
                sum += (double)values[4 * at + c] * values[4 * at + c];
            sums[3 * x + c] = (float)(sum / count);
        }
}

void pixel_noise_pool(float *plane, int columns, int rows)
{
    size_t size = 3 * (size_t)columns;
    float *squares = xmalloc(size * (size_t)rows * sizeof *squares);

    for (int row = 0; row < rows; row++)
        sum_columns(plane, columns, row, squares + size * (size_t)row);
    for (int row = 0; row < rows; row++)
        for (size_t i = 0; i < size; i++) {
            float sum = 0.0f;
            int count = 0;

            for (int at = row > REACH ? row - REACH : 0; at <= row + REACH && at < rows; at++, count++)
                sum += squares[size * (size_t)at + i];
            plane[4 * ((size_t)columns * (size_t)row + i / 3) + i % 3] = sqrtf(sum / (float)count);
        }
    free(squares);
}

void pixel_noise_lower(const float *noise, float scale, int columns, float *doubt)
{
    for (int x = 0; x < columns; x++)
        if (doubt[x] > 1.0f && doubt[x] <= SIGMAS * BEND * scale * largest(noise + 4 * x)) doubt[x] = 1.0f;
}

bool pixel_noise_explains(const float *noise, float off)
{
    return off <= SIGMAS * DIFFERENCE * largest(noise);
}
