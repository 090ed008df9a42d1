// SPDX-License-Identifier: Apache-2.0
#include "reference/path_pull.h"

#include <math.h>

static const double PI = 3.14159265358979323846;
// Of the transport mean free path, from a face to where the light inside would be none: Milne's problem.
static const double BEYOND = 0.71;

void path_pull_add(struct path_pull *pull, struct vec3 lamp, double power_w)
{
    pull->lamps[pull->count] = lamp;
    pull->powers[pull->count++] = power_w;
}

void path_pull_set_fall(struct path_pull *pull, double extinction, double absorption, const struct box *box)
{
    const double half[3] = {box->half.x, box->half.y, box->half.z};
    double square = 3.0 * extinction * absorption;

    for (int a = 0; a < 3; a++)
        square += pow(PI / (2.0 * (half[a] + BEYOND / extinction)), 2.0);
    pull->fall = sqrt(square);
}

double path_pull_at(const struct path_pull *pull, struct vec3 position)
{
    double sum = 0.0;

    for (size_t i = 0; i < pull->count; i++)
        sum += pull->powers[i] * exp(-pull->fall * vec3_length(vec3_subtract(position, pull->lamps[i])));
    return sum;
}
