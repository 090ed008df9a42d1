// SPDX-License-Identifier: Apache-2.0
#include "reference/dome.h"

#include <math.h>

// Rodrigues' formula.
struct vec3 dome_turn(const struct dome *dome, struct vec3 direction, double angle)
{
    double cosine = cos(angle), along = vec3_dot(dome->axis, direction);

    return vec3_add(vec3_add(vec3_scale(direction, cosine), vec3_scale(vec3_cross(dome->axis, direction), sin(angle))),
                    vec3_scale(dome->axis, along * (1.0 - cosine)));
}

static const float *texel_at(const struct dome *dome, double column, double row)
{
    double width = dome->width, wrapped = column - width * floor(column / width);
    double kept = fmin(fmax(row, 0.0), dome->height - 1.0);

    return &dome->rgb[3 * ((size_t)kept * (size_t)dome->width + (size_t)wrapped % (size_t)dome->width)];
}

static void look_up(const struct dome *dome, struct vec3 toward, double value[static 3])
{
    struct vec3 own = dome_turn(dome, toward, -dome->angle);
    double across = (0.5 - atan2(own.x, own.z) / (2.0 * M_PI)) * dome->width - 0.5;
    double down = (0.5 - asin(fmin(fmax(own.y, -1.0), 1.0)) / M_PI) * dome->height - 0.5;
    double column = floor(across), row = floor(down), right = across - column, below = down - row;

    for (int c = 0; c < 3; c++) {
        double upper = (1.0 - right) * texel_at(dome, column, row)[c] + right * texel_at(dome, column + 1.0, row)[c];
        double lower =
            (1.0 - right) * texel_at(dome, column, row + 1.0)[c] + right * texel_at(dome, column + 1.0, row + 1.0)[c];

        value[c] = (1.0 - below) * upper + below * lower;
    }
}

void dome_radiance(const struct dome *dome, struct vec3 toward, double radiance[static 3])
{
    double value[3] = {1.0, 1.0, 1.0}, share = 0.5 * (1.0 + vec3_dot(toward, dome->axis));

    switch (dome->kind) {
    case SCENE_DOME_RADIANCE:
        for (int c = 0; c < 3; c++)
            radiance[c] = dome->along[c];
        return;
    case SCENE_DOME_GRADIENT:
        for (int c = 0; c < 3; c++)
            radiance[c] = dome->against[c] + (dome->along[c] - dome->against[c]) * share;
        return;
    case SCENE_DOME_FILE:
        if (dome->width > 0) look_up(dome, toward, value);
        for (int c = 0; c < 3; c++)
            radiance[c] = dome->width > 0 ? dome->along[c] * value[c] : 0.0;
        return;
    }
}
