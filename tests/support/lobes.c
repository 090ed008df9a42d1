// SPDX-License-Identifier: Apache-2.0
#include "tests/support/lobes.h"

#include "tests/support/volume_maker.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static double lobe(double x, double y, double z, const double center[3], double radius)
{
    double square = pow(x - center[0], 2) + pow(y - center[1], 2) + pow(z - center[2], 2);
    double inside = fmax(1 - square / (radius * radius), 0);

    return inside * inside;
}

static double value_at(double x, double y, double z)
{
    static const double centers[3][3] = {{0.3, 0.35, 0.4}, {0.7, 0.3, 0.6}, {0.35, 0.75, 0.75}};
    static const double radii[3] = {0.3, 0.22, 0.16}, heights[3] = {1, 0.7, 0.85};
    double value = 0;

    for (int i = 0; i < 3; i++)
        value += heights[i] * lobe(x, y, z, centers[i], radii[i]);
    return value;
}

void lobes_write(const char *path, const int size[3], const char *axes)
{
    size_t count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2], at = 0;
    double directions[3][3];
    char header[512];
    size_t length;
    char *bytes;

    assert_int_equal(sscanf(axes, "space directions: (%lf,%lf,%lf) (%lf,%lf,%lf) (%lf,%lf,%lf)", &directions[0][0],
                            &directions[0][1], &directions[0][2], &directions[1][0], &directions[1][1],
                            &directions[1][2], &directions[2][0], &directions[2][1], &directions[2][2]),
                     9);
    snprintf(
        header, sizeof header,
        "NRRD0004\ntype: float\ndimension: 3\nspace dimension: 3\nsizes: %d %d %d\n%sspace origin: (%.17g,%.17g,"
        "%.17g)\nendian: little\nencoding: raw\n\n",
        size[0], size[1], size[2], axes,
        -0.5 * ((size[0] - 1) * directions[0][0] + (size[1] - 1) * directions[1][0] + (size[2] - 1) * directions[2][0]),
        -0.5 * ((size[0] - 1) * directions[0][1] + (size[1] - 1) * directions[1][1] + (size[2] - 1) * directions[2][1]),
        -0.5 *
            ((size[0] - 1) * directions[0][2] + (size[1] - 1) * directions[1][2] + (size[2] - 1) * directions[2][2]));
    length = strlen(header);
    bytes = calloc(1, length + count * sizeof(float));
    memcpy(bytes, header, length);
    for (int k = 0; k < size[2]; k++)
        for (int j = 0; j < size[1]; j++)
            for (int i = 0; i < size[0]; i++, at++) {
                float value = (float)value_at((i + 0.5) / size[0], (j + 0.5) / size[1], (k + 0.5) / size[2]);

                memcpy(bytes + length + at * sizeof value, &value, sizeof value);
            }
    volume_maker_write(path, bytes, length + count * sizeof(float));
    free(bytes);
}
