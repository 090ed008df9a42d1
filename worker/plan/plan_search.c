// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_search.h"

#include <math.h>
#include <string.h>

enum {
    STRIDE = 2,     // rungs per refinement
    STRIDE_MOST = 8 // rungs by which an axis is made coarser at once
};

// The least gain of a refinement: the fall of log(error) divided by the rise of log(work). Set by hand;
// tests/worker/plan/tolerance_random_test and bench/predictions show its effect.
static const double GAIN_MIN = 0.02;
static const double WORK_MULTIPLE = 2.0;

struct walk {
    const struct plan_search *search;
    struct {
        struct plan_point point;
        double error; // INFINITY: it could not be measured
    } seen[PLAN_MEASURE_LIMIT];
    int seen_count;
    int too_coarse[PLAN_AXIS_LIMIT]; // rungs by which the axis cannot become coarser; 0: not known
    bool is_stopped, is_over_limit;
};

static bool is_same(const struct walk *walk, const struct plan_point *a, const struct plan_point *b)
{
    return memcmp(a->rungs, b->rungs, (size_t)walk->search->axis_count * sizeof *a->rungs) == 0;
}

static double work_of(const struct walk *walk, const struct plan_point *point)
{
    return walk->search->work(walk->search->user, point);
}

// INFINITY for a point that cannot be measured, is over the work limit, or would be one measurement too many.
static double error_at(struct walk *walk, const struct plan_point *point)
{
    const struct plan_search *search = walk->search;
    double error = INFINITY;

    if (work_of(walk, point) >= search->work_limit) {
        walk->is_over_limit = true;
        return INFINITY;
    }
    for (int i = 0; i < walk->seen_count; i++)
        if (is_same(walk, &walk->seen[i].point, point)) return walk->seen[i].error;
    if (walk->is_stopped || walk->seen_count == PLAN_MEASURE_LIMIT) return INFINITY;
    switch (search->measure(search->user, point, &error)) {
    case PLAN_MEASURED:
        if (isnan(error)) error = INFINITY;
        break;
    case PLAN_CANNOT:
        error = INFINITY;
        break;
    case PLAN_STOPPED:
        walk->is_stopped = true;
        return INFINITY;
    }
    walk->seen[walk->seen_count].point = *point;
    walk->seen[walk->seen_count++].error = error;
    return error;
}

// False when the axis has no such rung; a last, shorter step to its finest rung is allowed.
static bool move(const struct walk *walk, struct plan_point *point, int axis, int by)
{
    int last = walk->search->last_rung[axis], rung = point->rungs[axis] + by;

    if (rung > last && point->rungs[axis] < last) rung = last;
    if (rung < 0 || rung > last) return false;
    point->rungs[axis] = rung;
    return true;
}

// Refines an axis by STRIDE, or by one rung where STRIDE multiplies the work: grids fill with the cube of their cells.
static bool refine_axis(const struct walk *walk, struct plan_point *point, int axis)
{
    struct plan_point far = *point;

    if (!move(walk, &far, axis, STRIDE)) return false;
    if (work_of(walk, &far) > WORK_MULTIPLE * work_of(walk, point)) return move(walk, point, axis, 1);
    *point = far;
    return true;
}

// Refines the axis with the largest gain; all axes, if none gains enough. False when nothing can be refined or
// measured.
static bool refine(struct walk *walk, struct plan_point *point, double *error)
{
    struct plan_point best = *point, all = *point;
    double best_gain = GAIN_MIN, work = work_of(walk, point);
    bool moved = false;

    for (int axis = 0; axis < walk->search->axis_count; axis++) {
        struct plan_point next = *point;
        double next_error, gain;

        moved |= move(walk, &all, axis, STRIDE);
        if (!refine_axis(walk, &next, axis)) continue;
        next_error = error_at(walk, &next);
        if (walk->is_stopped) return false;
        if (isinf(next_error) || next_error >= *error) continue;
        gain = log(*error / next_error) / fmax(log(work_of(walk, &next) / work), 1e-3);
        if (gain <= best_gain) continue;
        best_gain = gain;
        best = next;
    }
    if (is_same(walk, &best, point)) best = all;
    if (!moved) return false;
    *point = best;
    *error = error_at(walk, &best);
    return isfinite(*error);
}

// By how many rungs a coarser axis may keep the target: an error of second order doubles with each.
static int find_stride(const struct walk *walk, double error)
{
    double far = floor(log2(walk->search->target / error));

    return (int)fmin(fmax(far, STRIDE), STRIDE_MOST);
}

// Moves to the point with the least work of those that are coarser in one axis, by so many rungs, and keep the target.
// What was too coarse stays so while other axes become coarser.
static bool coarsen_axis(struct walk *walk, struct plan_point *point, double *error, int by)
{
    for (;;) {
        struct plan_point best = *point;
        double least = work_of(walk, point);
        int tried = -1;

        for (int axis = 0; axis < walk->search->axis_count; axis++) {
            struct plan_point next = *point;

            if (walk->too_coarse[axis] > 0 && by >= walk->too_coarse[axis]) continue;
            if (!move(walk, &next, axis, -by) || work_of(walk, &next) >= least) continue;
            best = next;
            least = work_of(walk, &next);
            tried = axis;
        }
        if (tried < 0) return false;
        if (error_at(walk, &best) <= walk->search->target) {
            *point = best;
            *error = error_at(walk, &best);
            return true;
        }
        walk->too_coarse[tried] = by;
    }
}

// Makes one axis coarser and another finer, where that saves work.
static bool exchange(struct walk *walk, struct plan_point *point, double *error)
{
    int count = walk->search->axis_count;

    for (int k = 0; k < count * count; k++) {
        struct plan_point next = *point;

        if (k / count == k % count || !move(walk, &next, k / count, -1) || !move(walk, &next, k % count, 1)) continue;
        if (work_of(walk, &next) >= work_of(walk, point) || error_at(walk, &next) > walk->search->target) continue;
        *point = next;
        *error = error_at(walk, &next);
        memset(walk->too_coarse, 0, sizeof walk->too_coarse);
        return true;
    }
    return false;
}

// Moves to a neighbour with less work that keeps the target; the farther below the target, the farther.
static bool coarsen(struct walk *walk, struct plan_point *point, double *error)
{
    for (int by = find_stride(walk, *error); by >= 1; by /= 2)
        if (coarsen_axis(walk, point, error, by)) return true;
    return exchange(walk, point, error);
}

struct plan_finding plan_search_run(const struct plan_search *search)
{
    struct walk walk = {.search = search};
    struct plan_finding finding = {.found = PLAN_MISSED, .point = search->start};
    struct plan_point point = search->start;
    double error = error_at(&walk, &point);

    // The start may be impossible to measure or over the work limit: coarser points are tried.
    for (int axis = 0; isinf(error) && !walk.is_stopped && axis < 2 * search->axis_count; axis++)
        if (move(&walk, &point, axis % search->axis_count, -STRIDE)) error = error_at(&walk, &point);
    finding.error = error;
    finding.point = point;
    while (error > search->target && isfinite(error) && refine(&walk, &point, &error)) {
        finding.point = point;
        finding.error = error;
    }
    if (isfinite(error) && error <= search->target) {
        while (!walk.is_stopped && coarsen(&walk, &point, &error))
            ;
        finding = (struct plan_finding){.found = PLAN_FOUND, .point = point, .error = error};
    }
    finding.work = work_of(&walk, &finding.point);
    finding.measured = walk.seen_count;
    if (finding.found != PLAN_FOUND && walk.is_over_limit) finding.found = PLAN_OVER_LIMIT;
    if (walk.is_stopped) finding.found = PLAN_GAVE_UP;
    return finding;
}
