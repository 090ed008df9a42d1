// SPDX-License-Identifier: Apache-2.0
#include "reference/path_pull.h"

#include <math.h>

static const double PI = 3.14159265358979323846;
// Of the transport mean free path, from a face to where the light inside would be none: Milne's problem.
static const double BEYOND = 0.71;

double path_pull_fall(double extinction, double absorption, const struct box *box)
{
    const double half[3] = {box->half.x, box->half.y, box->half.z};
    double square = 3.0 * extinction * absorption;

    for (int a = 0; a < 3; a++)
        square += pow(PI / (2.0 * (half[a] + BEYOND / extinction)), 2.0);
    return sqrt(square);
}

void path_pull_add(struct path_pull *pull, const struct path_pull_lamp *lamp)
{
    pull->lamps[pull->count++] = *lamp;
}

double path_pull_at(const struct path_pull *pull, struct vec3 position)
{
    double sum = 0.0;

    for (size_t i = 0; i < pull->count; i++) {
        const struct path_pull_lamp *lamp = &pull->lamps[i];

        sum += lamp->power * exp(-lamp->fall * vec3_length(vec3_subtract(position, lamp->position)));
    }
    return sum;
}

double path_pull_growth(const struct path_pull *pull, struct vec3 position, double first)
{
    return first > 0.0 ? fmin(fmax(path_pull_at(pull, position) / first, 1.0), PATH_PULL_MOST) : 1.0;
}
