// SPDX-License-Identifier: Apache-2.0
#include "reference/dome_sampler.h"

#include "core/base/alloc.h"

#include <math.h>
#include <stdlib.h>

static double mean_of(const double color[static 3])
{
    return (color[0] + color[1] + color[2]) / 3.0;
}

// The height (the sine of the elevation) of the upper border of an image's row.
static double row_top(const struct dome *dome, size_t row)
{
    return sin(M_PI * (0.5 - (double)row / dome->height));
}

static double texel_angle(const struct dome *dome, size_t row)
{
    return 2.0 * M_PI / dome->width * (row_top(dome, row) - row_top(dome, row + 1));
}

// The mean of the three colours over a texel: of a bilinear image the neighbours count with an eighth on each side.
static double texel_mean(const struct dome *dome, size_t column, size_t row)
{
    static const double SHARES[] = {0.125, 0.75, 0.125};
    size_t width = (size_t)dome->width, height = (size_t)dome->height;
    double mean = 0.0;

    for (size_t j = 0; j < 3; j++) {
        size_t at = row + j == 0 ? 0 : row + j - 1;

        if (at >= height) at = height - 1;
        for (size_t i = 0; i < 3; i++) {
            const float *texel = &dome->rgb[3 * (at * width + (column + i + width - 1) % width)];

            for (int c = 0; c < 3; c++)
                mean += SHARES[i] * SHARES[j] * dome->along[c] * texel[c] / 3.0;
        }
    }
    return mean;
}

void dome_sampler_init(struct dome_sampler *sampler, const struct dome *dome)
{
    size_t width = (size_t)dome->width, height = (size_t)dome->height;
    double total = 0.0;

    *sampler = (struct dome_sampler){.dome = dome};
    if (dome->kind != SCENE_DOME_FILE || width == 0) return;
    sampler->sums = xcalloc(width * height + height, sizeof sampler->sums[0]);
    sampler->row_sums = sampler->sums + width * height;
    for (size_t row = 0; row < height; row++) {
        double sum = 0.0, angle = texel_angle(dome, row);

        for (size_t column = 0; column < width; column++) {
            sum += angle * texel_mean(dome, column, row);
            sampler->sums[row * width + column] = sum;
        }
        total += sum;
        sampler->row_sums[row] = total;
    }
    if (total > 0.0) return;
    dome_sampler_finish(sampler);
    sampler->dome = dome;
}

void dome_sampler_finish(struct dome_sampler *sampler)
{
    free(sampler->sums);
    *sampler = (struct dome_sampler){0};
}

// The first of `count` growing sums above u times the last.
static size_t find(const double *sums, size_t count, double u)
{
    double wanted = u * sums[count - 1];
    size_t low = 0, high = count - 1;

    while (low < high) {
        size_t middle = (low + high) / 2;

        if (sums[middle] > wanted)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static struct vec3 draw_in_image(const struct dome_sampler *sampler, const double u[static 4])
{
    const struct dome *dome = sampler->dome;
    size_t width = (size_t)dome->width, row = find(sampler->row_sums, (size_t)dome->height, u[0]);
    size_t column = find(&sampler->sums[row * width], width, u[1]);
    double y = row_top(dome, row) + u[2] * (row_top(dome, row + 1) - row_top(dome, row));
    double turn = 2.0 * M_PI * (0.5 - ((double)column + u[3]) / dome->width), aside = sqrt(fmax(1.0 - y * y, 0.0));

    return dome_turn(dome, (struct vec3){aside * sin(turn), y, aside * cos(turn)}, dome->angle);
}

// A direction whose cosine to `axis` is `cosine`.
static struct vec3 about(struct vec3 axis, double cosine, double turn)
{
    struct vec3 any = fabs(axis.x) < 0.5 ? (struct vec3){1.0, 0.0, 0.0} : (struct vec3){0.0, 1.0, 0.0};
    struct vec3 right = vec3_normalize(vec3_cross(any, axis)), up = vec3_cross(axis, right);
    double aside = sqrt(fmax(1.0 - cosine * cosine, 0.0));
    struct vec3 side = vec3_add(vec3_scale(right, cos(turn)), vec3_scale(up, sin(turn)));

    return vec3_add(vec3_scale(axis, cosine), vec3_scale(side, aside));
}

// The share of a gradient's light that its part along the axis brings; a half: directions are even.
static double find_part(const struct dome *dome)
{
    double along = mean_of(dome->along), against = mean_of(dome->against);

    return dome->kind == SCENE_DOME_GRADIENT && along + against > 0.0 ? along / (along + against) : 0.5;
}

struct vec3 dome_sampler_draw(const struct dome_sampler *sampler, const double u[static 4])
{
    static const struct vec3 UP = {0.0, 1.0, 0.0};
    const struct dome *dome = sampler->dome;
    double part = find_part(dome), above = 2.0 * sqrt(u[1]) - 1.0; // with a density of (1 + cosine) / 2

    if (sampler->sums) return draw_in_image(sampler, u);
    return about(dome->kind == SCENE_DOME_GRADIENT ? dome->axis : UP, u[0] < part ? above : -above, 2.0 * M_PI * u[2]);
}

double dome_sampler_density(const struct dome_sampler *sampler, struct vec3 toward)
{
    const struct dome *dome = sampler->dome;
    size_t width = (size_t)dome->width, height = (size_t)dome->height, row, column;
    double part = find_part(dome), below;
    struct vec3 own;

    if (!sampler->sums) return (1.0 + (2.0 * part - 1.0) * vec3_dot(toward, dome->axis)) / (4.0 * M_PI);
    own = dome_turn(dome, toward, -dome->angle);
    row = (size_t)fmax((0.5 - asin(fmin(fmax(own.y, -1.0), 1.0)) / M_PI) * dome->height, 0.0);
    column = (size_t)fmax((0.5 - atan2(own.x, own.z) / (2.0 * M_PI)) * dome->width, 0.0);
    if (row >= height) row = height - 1;
    if (column >= width) column = width - 1;
    below = column > 0 ? sampler->sums[row * width + column - 1] : 0.0;
    return (sampler->sums[row * width + column] - below) / sampler->row_sums[height - 1] / texel_angle(dome, row);
}
