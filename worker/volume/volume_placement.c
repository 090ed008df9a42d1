// SPDX-License-Identifier: Apache-2.0
#include "worker/volume/volume_placement.h"

#include "core/base/error.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static void column(const double m[12], int axis, double vector[3])
{
    for (size_t row = 0; row < 3; row++)
        vector[row] = m[4 * row + (size_t)axis];
}

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void volume_placement_centered(double index_to_world[12], const int size[3], const double spacing[3])
{
    memset(index_to_world, 0, 12 * sizeof *index_to_world);
    for (size_t axis = 0; axis < 3; axis++) {
        index_to_world[5 * axis] = spacing[axis];
        index_to_world[4 * axis + 3] = -0.5 * (size[axis] - 1) * spacing[axis];
    }
}

void volume_placement_unit(double index_to_world[12], const int size[3])
{
    double longest = fmax(size[0], fmax(size[1], size[2]));
    double spacing[3] = {1.0 / longest, 1.0 / longest, 1.0 / longest};

    volume_placement_centered(index_to_world, size, spacing);
}

void volume_placement_respace(double index_to_world[12], const int size[3], const double spacing[3])
{
    for (int axis = 0; axis < 3; axis++) {
        double vector[3];
        double factor;

        column(index_to_world, axis, vector);
        factor = spacing[axis] / length(vector);
        for (size_t row = 0; row < 3; row++) {
            double before = vector[row];

            index_to_world[4 * row + (size_t)axis] = before * factor;
            index_to_world[4 * row + 3] += 0.5 * (size[axis] - 1) * before * (1.0 - factor);
        }
    }
}

bool volume_placement_check(const double index_to_world[12], struct error *error)
{
    const double *m = index_to_world;
    double lengths[3];
    double determinant;

    for (size_t i = 0; i < 12; i++) {
        if (isfinite(m[i])) continue;
        error_set(error, "expected finite numbers for the voxels' positions, got %g", m[i]);
        return false;
    }
    for (int axis = 0; axis < 3; axis++) {
        double vector[3];

        column(m, axis, vector);
        lengths[axis] = length(vector);
        // Sides far smaller or larger than any instrument's would underflow or overflow in single precision.
        if (lengths[axis] > 1e-12 && lengths[axis] < 1e12) continue;
        error_set(error, "expected a voxel's side along %c between 1e-12 m and 1e12 m, got %g m", "ijk"[axis],
                  lengths[axis]);
        return false;
    }
    determinant =
        m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]);
    if (fabs(determinant) > 1e-6 * lengths[0] * lengths[1] * lengths[2]) return true;
    error_set(error, "the directions of the three axes lie in one plane");
    return false;
}
