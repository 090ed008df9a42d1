// SPDX-License-Identifier: Apache-2.0
#include "reference/texture.h"

#include <math.h>

static struct texture_coordinates find_on_face(const struct texture *texture, struct vec3 offset, struct vec3 normal)
{
    struct vec3 upwards = fabs(normal.y) > 0.999 ? (struct vec3){0.0, 0.0, -1.0} : (struct vec3){0.0, 1.0, 0.0};
    struct vec3 right = vec3_normalize(vec3_cross(upwards, normal));
    struct vec3 up = vec3_cross(normal, right);
    double across = texture->size[0], high = texture->size[1];

    if (high == 0.0) high = across * texture->height / texture->width;
    return (struct texture_coordinates){0.5 + vec3_dot(offset, right) / across, 0.5 + vec3_dot(offset, up) / high};
}

static struct texture_coordinates find_on_sphere(struct vec3 normal)
{
    return (struct texture_coordinates){0.5 + atan2(normal.x, normal.z) / (2.0 * M_PI),
                                        0.5 + asin(fmin(fmax(normal.y, -1.0), 1.0)) / M_PI};
}

struct texture_coordinates texture_find(const struct texture *texture, const struct shape *shape, struct vec3 position)
{
    struct vec3 normal = shape_normal(shape, position), offset = vec3_subtract(position, shape->center);

    // The part of the offset along the normal leads to the face's centre and changes neither u nor v.
    return shape->kind == SCENE_SHAPE_SPHERE ? find_on_sphere(normal) : find_on_face(texture, offset, normal);
}

static int wrap(double texel, int count)
{
    return (int)(texel - count * floor(texel / count)) % count;
}

static const float *texel_at(const struct texture *texture, double column, double row)
{
    return &texture->rgb[3 * ((size_t)wrap(row, texture->height) * (size_t)texture->width +
                              (size_t)wrap(column, texture->width))];
}

void texture_sample(const struct texture *texture, struct texture_coordinates at, double color[static 3])
{
    double across = at.u * texture->width, down = (1.0 - at.v) * texture->height;
    double column = floor(across - 0.5), row = floor(down - 0.5);
    double right = across - 0.5 - column, below = down - 0.5 - row;

    for (int c = 0; c < 3; c++) {
        if (texture->is_nearest) {
            color[c] = texel_at(texture, floor(across), floor(down))[c];
        } else {
            double upper =
                (1.0 - right) * texel_at(texture, column, row)[c] + right * texel_at(texture, column + 1.0, row)[c];
            double lower = (1.0 - right) * texel_at(texture, column, row + 1.0)[c] +
                           right * texel_at(texture, column + 1.0, row + 1.0)[c];

            color[c] = (1.0 - below) * upper + below * lower;
        }
    }
}
