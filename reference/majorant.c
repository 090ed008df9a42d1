// SPDX-License-Identifier: Apache-2.0
#include "reference/majorant.h"

#include "core/base/alloc.h"

#include <math.h>
#include <stdlib.h>

enum { BRICKS = 32 }; // along the longest side

// A density that is computed in another order may exceed its bound by rounding.
static const double ROUNDING = 1.0 + 1e-12;

static struct vec3 brick_middle(const struct majorant *majorant, int i, int j, int k)
{
    struct vec3 offset = {(i + 0.5) * majorant->side[0], (j + 0.5) * majorant->side[1], (k + 0.5) * majorant->side[2]};

    return vec3_add(majorant->low, offset);
}

static void fill(struct majorant *majorant)
{
    const struct density *density = majorant->density;
    const double *side = majorant->side;
    // Positions on a face belong to either side.
    const double half = 0.5 + 1e-9;
    struct box box = {.half = {half * side[0], half * side[1], half * side[2]}};
    double *brick = majorant->bricks;

    for (int k = 0; k < majorant->count[2]; k++)
        for (int j = 0; j < majorant->count[1]; j++)
            for (int i = 0; i < majorant->count[0]; i++) {
                box.center = brick_middle(majorant, i, j, k);
                *brick = density->most(density->field, &box) * ROUNDING;
                majorant->most = fmax(majorant->most, *brick++);
            }
}

static void lay_bricks(struct majorant *majorant, const struct box *extent)
{
    const double half[3] = {extent->half.x, extent->half.y, extent->half.z};
    double longest = fmax(fmax(half[0], half[1]), half[2]);
    size_t count = 1;

    majorant->low = vec3_subtract(extent->center, extent->half);
    for (int a = 0; a < 3; a++) {
        majorant->count[a] = majorant->is_even ? 1 : (int)fmax(ceil(BRICKS * half[a] / longest), 1.0);
        majorant->side[a] = 2.0 * half[a] / majorant->count[a];
        count *= (size_t)majorant->count[a];
    }
    majorant->bricks = xcalloc(count, sizeof majorant->bricks[0]);
    fill(majorant);
}

bool majorant_init(struct majorant *majorant, const struct density *density)
{
    static const struct box EVERYWHERE = {.half = {INFINITY, INFINITY, INFINITY}};
    struct box extent;

    *majorant = (struct majorant){.density = density, .is_even = density->column && density->reach};
    if (!density->most) return false;
    if (density->extent && density->extent(density->field, &extent)) {
        // A density that is nowhere has no bricks.
        if (!(extent.half.x > 0.0 && extent.half.y > 0.0 && extent.half.z > 0.0)) return true;
        lay_bricks(majorant, &extent);
        if (majorant->is_even && density->clip) majorant->endless = majorant->most;
    } else {
        majorant->most = majorant->endless = density->most(density->field, &EVERYWHERE) * ROUNDING;
    }
    return isfinite(majorant->most);
}

void majorant_finish(struct majorant *majorant)
{
    free(majorant->bricks);
    *majorant = (struct majorant){0};
}

static double bound_of(const struct majorant *majorant, const int brick[static 3])
{
    size_t row = (size_t)brick[1] + (size_t)majorant->count[1] * (size_t)brick[2];

    return majorant->bricks[(size_t)brick[0] + (size_t)majorant->count[0] * row];
}

double majorant_at(const struct majorant *majorant, struct vec3 position)
{
    struct vec3 from_low = vec3_subtract(position, majorant->low);
    const double offset[3] = {from_low.x, from_low.y, from_low.z};
    int brick[3];

    if (!majorant->bricks) return majorant->endless;
    for (int a = 0; a < 3; a++) {
        double index = offset[a] / majorant->side[a];

        if (index < 0.0 || index > majorant->count[a]) return 0.0;
        brick[a] = (int)fmin(index, majorant->count[a] - 1);
    }
    return bound_of(majorant, brick);
}

// The distance at which the ray leaves the current brick along an axis.
static double leave_axis(const struct flight *flight, int axis)
{
    const struct majorant *majorant = flight->majorant;
    double direction = flight->direction[axis];
    double face = (flight->brick[axis] + (direction > 0.0 ? 1 : 0)) * majorant->side[axis];

    return direction != 0.0 ? (face - flight->origin[axis]) * flight->inverse[axis] : INFINITY;
}

static void look_at_brick(struct flight *flight)
{
    const double *leave = flight->leave;

    flight->axis = leave[1] < leave[0] ? 1 : 0;
    flight->axis = leave[2] < leave[flight->axis] ? 2 : flight->axis;
    flight->end = fmin(leave[flight->axis], flight->far);
    flight->most = bound_of(flight->majorant, flight->brick);
}

static void clip_to_bricks(const struct flight *flight, double *near, double *far)
{
    const struct majorant *majorant = flight->majorant;

    for (int a = 0; a < 3; a++) {
        double origin = flight->origin[a], direction = flight->direction[a];
        double width = majorant->count[a] * majorant->side[a];

        if (direction != 0.0) {
            double first = -origin / direction, last = (width - origin) / direction;

            *near = fmax(*near, fmin(first, last));
            *far = fmin(*far, fmax(first, last));
        } else if (origin < 0.0 || origin > width) {
            *far = *near;
        }
    }
}

static void begin_in_bricks(struct flight *flight, const struct ray *ray, double near, double far)
{
    const struct majorant *majorant = flight->majorant;
    struct vec3 origin = vec3_subtract(ray->origin, majorant->low);

    for (int a = 0; a < 3; a++) {
        flight->origin[a] = a == 0 ? origin.x : a == 1 ? origin.y : origin.z;
        flight->direction[a] = a == 0 ? ray->direction.x : a == 1 ? ray->direction.y : ray->direction.z;
        flight->inverse[a] = 1.0 / flight->direction[a];
    }
    clip_to_bricks(flight, &near, &far);
    flight->at = near;
    flight->far = far;
    if (!(near < far)) return;
    for (int a = 0; a < 3; a++) {
        double index = (flight->origin[a] + flight->direction[a] * near) / majorant->side[a];

        flight->brick[a] = (int)fmin(fmax(index, 0.0), majorant->count[a] - 1);
        flight->leave[a] = leave_axis(flight, a);
    }
    look_at_brick(flight);
}

void flight_begin(struct flight *flight, const struct majorant *majorant, const struct ray *ray, double near,
                  double far)
{
    const struct density *density = majorant->density;

    *flight = (struct flight){.majorant = majorant, .at = near, .far = near};
    if (density->clip && !density->clip(density->field, ray, &near, &far)) return;
    if (majorant->endless > 0.0) {
        flight->at = near;
        flight->end = flight->far = far;
        flight->most = majorant->endless;
    } else if (majorant->bricks) {
        begin_in_bricks(flight, ray, near, far);
    }
}

// False at the end of the bricks.
static bool enter_next_brick(struct flight *flight)
{
    int axis = flight->axis;

    flight->at = fmax(flight->end, flight->at);
    if (flight->majorant->endless > 0.0 || !flight->majorant->bricks || !(flight->at < flight->far)) return false;
    flight->brick[axis] += flight->direction[axis] > 0.0 ? 1 : -1;
    if (flight->brick[axis] < 0 || flight->brick[axis] >= flight->majorant->count[axis]) return false;
    flight->leave[axis] = leave_axis(flight, axis);
    look_at_brick(flight);
    return true;
}

double flight_advance(struct flight *flight, double column)
{
    while (flight->at < flight->far) {
        if (flight->most > 0.0) {
            double room = (flight->end - flight->at) * flight->most;

            if (column < room) return flight->at += column / flight->most;
            column -= fmax(room, 0.0);
        }
        if (!enter_next_brick(flight)) flight->at = flight->far;
    }
    return INFINITY;
}

double flight_column(const struct flight *flight)
{
    struct flight rest = *flight;
    double column = 0.0;

    while (rest.at < rest.far) {
        if (rest.most > 0.0) column += fmax(rest.end - rest.at, 0.0) * rest.most;
        if (!enter_next_brick(&rest)) break;
    }
    return column;
}
