// Affine maps between voxels and the world.
// SPDX-License-Identifier: Apache-2.0
#pragma once

// `matrix` is row-major 3x4 and not singular. Writes the inverse of its linear part, column-major, and the shift of the
// inverse map.
void affine_invert(const double matrix[static 12], double inverse[static 9], double shift[static 3]);
