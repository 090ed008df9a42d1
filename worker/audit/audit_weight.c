// SPDX-License-Identifier: Apache-2.0
#include "worker/audit/audit_weight.h"

#include "worker/picture/four.h"
#include "worker/picture/image.h"

#include <math.h>
#include <stdbool.h>

enum { REACH = 2, CHUNK = 64 }; // px; pixels whose sums are kept in float

// Without the calls that NaN and signed zeros would need, compilers make SIMD code of these.
static float least(float a, float b)
{
    return a < b ? a : b;
}

static float most(float a, float b)
{
    return a > b ? a : b;
}

double audit_weight_square(const struct image *image, size_t pixel)
{
    const float *own = &image->rgba[4 * pixel];

    return ((double)own[0] * own[0] + (double)own[1] * own[1] + (double)own[2] * own[2]) / 3.0;
}

double audit_weight_spike(const struct image *image, size_t pixel)
{
    size_t width = (size_t)image->width_px, x = pixel % width, y = pixel / width, near[4];
    double sum = 0.0;
    int count = 0;

    if (x >= REACH) near[count++] = pixel - REACH;
    if (x + REACH < width) near[count++] = pixel + REACH;
    if (y >= REACH) near[count++] = pixel - REACH * width;
    if (y + REACH < (size_t)image->height_px) near[count++] = pixel + REACH * width;
    for (size_t c = 0; count > 0 && c < 3; c++) {
        float own = image->rgba[4 * pixel + c], low = INFINITY, high = -INFINITY;
        double off;

        for (int k = 0; k < count; k++) {
            low = least(low, image->rgba[4 * near[k] + c]);
            high = most(high, image->rgba[4 * near[k] + c]);
        }
        off = most(most(low - own, own - high), 0.0f);
        sum += off * off / 3.0;
    }
    return sum;
}

double audit_weight_cut(const struct image *image, size_t pixel)
{
    return image->cut ? (double)image->cut[pixel] * image->cut[pixel] : 0.0;
}

// Sums over up to CHUNK pixels.
struct sums {
    four squares, spikes, brightest;
};

// Pixels that have all four neighbours, REACH pixels and `stride` floats away.
static four sum_spikes(const float *own, size_t stride, size_t count)
{
    four sum = {0.0f};

    for (size_t i = 0; i < 4 * count; i += 4) {
        const float *at = own + i;
        four middle = four_load(at), left = four_load(at - 4 * REACH), right = four_load(at + 4 * REACH);
        four up = four_load(at - stride), down = four_load(at + stride);
        four low = four_least(four_least(left, right), four_least(up, down));
        four high = four_most(four_most(left, right), four_most(up, down));
        four off = four_most(four_most(low - middle, middle - high), (four){0.0f});

        sum += off * off;
    }
    return sum;
}

static struct sums sum_pixels(const float *own, size_t count)
{
    struct sums sums = {.brightest = {-INFINITY, -INFINITY, -INFINITY, -INFINITY}};

    for (size_t i = 0; i < 4 * count; i += 4) {
        four middle = four_load(own + i);

        sums.squares += middle * middle;
        sums.brightest = four_most(middle, sums.brightest);
    }
    return sums;
}

struct audit_weight_row audit_weight_row(const struct image *image, int y)
{
    size_t width = (size_t)image->width_px, first = (size_t)y * width, stride = REACH * 4 * width, x, end;
    bool is_inside = y >= REACH && y + REACH < image->height_px;
    struct audit_weight_row row = {.brightest = -INFINITY};

    for (x = 0; x < width; x = end) {
        const float *own = &image->rgba[4 * (first + x)];
        struct sums sums;
        bool is_edge = !is_inside || x < REACH || x + REACH >= width;

        end = x + CHUNK < width - REACH ? x + CHUNK : width - REACH;
        if (is_edge) end = x + 1;
        sums = sum_pixels(own, end - x);
        if (is_edge)
            row.spikes += audit_weight_spike(image, first + x);
        else
            sums.spikes = sum_spikes(own, stride, end - x);
        for (size_t c = 0; c < 3; c++) {
            row.squares += sums.squares[c] / 3.0;
            row.spikes += sums.spikes[c] / 3.0;
            row.brightest = most(sums.brightest[c], row.brightest);
        }
    }
    for (x = 0; image->cut && x < width; x++)
        row.cuts += audit_weight_cut(image, first + x);
    return row;
}
