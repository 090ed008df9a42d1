// SPDX-License-Identifier: Apache-2.0
#include "worker/density/affine.h"

void affine_invert(const double matrix[static 12], double inverse[static 9], double shift[static 3])
{
    const double *a = matrix, *b = matrix + 4, *c = matrix + 8;
    double determinant =
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    const double adjugate[9] = {b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0],
                                a[2] * c[1] - a[1] * c[2], a[0] * c[2] - a[2] * c[0], a[1] * c[0] - a[0] * c[1],
                                a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};

    for (int i = 0; i < 9; ++i)
        inverse[i] = adjugate[i] / determinant;
    for (int row = 0; row < 3; ++row)
        shift[row] = -(inverse[row] * matrix[3] + inverse[3 + row] * matrix[7] + inverse[6 + row] * matrix[11]);
}
