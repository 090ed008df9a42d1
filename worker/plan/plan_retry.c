// SPDX-License-Identifier: Apache-2.0
#include "worker/plan/plan_retry.h"

#include "worker/picture/image.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { DROP_LIMIT = 4 }; // rungs by which another family may be coarser than the one before

// Set by hand; tests/worker/plan/plan_retry_test shows what follows from them.
static const double GOAL = 0.5;                                      // of the tolerance: the error to expect,
static const double SCATTERED_GOAL = 0.8;                            // where work grows with its fourth power
static const double FALL = 0.59460355750136051;                      // of an error by a rung: 2^(-1.5 / 2)
static const double NOISE_FALL = 0.84089641525371454;                // of noise by a rung of paths: 2^(-0.5 / 2)
static const double WORK_SO_FAR[PLAN_RETRY_LIMIT] = {2.0, 5.0, 8.0}; // after each rendering, in units
static const double DARK_DEPTH = 20.0;
static const double HOPELESS = 2.0; // of the tolerance
static const double SETTLED =
    0.65; // of the tolerance: the error that later frames should have, as plan_make.c aims at,
static const double SCATTERED_SETTLED = 0.85; // above order 1
static const double TINY = 1e-12;             // an error of 0 has no logarithm

static double find_work(const struct plan_retry *retry, const struct plan *plan, const struct plan_point *point)
{
    struct job_quality quality = plan_family_quality(&plan_families[plan->family], &retry->scene, point);

    return plan_family_work(&retry->scene, &quality);
}

void plan_retry_init(struct plan_retry *retry, const struct job *job, const struct image *image,
                     const struct plan *plan)
{
    size_t pixels = image ? (size_t)image->width_px * (size_t)image->height_px : 0, hits = 0;
    size_t stride = pixels / PLAN_RETRY_DEPTHS + 1, seen = 0;

    *retry = (struct plan_retry){.tried = 1u << plan->family};
    plan_scene_init(&retry->scene, job);
    if (!image) retry->depths[hits++] = (float)(seen = 1);
    for (size_t i = 0; i < pixels; i += stride, seen++) {
        double through = 1.0 - image->rgba[4 * i + 3];

        if (through < 1.0) retry->depths[hits++] = (float)fmin(-log(fmax(through, 1e-30)), DARK_DEPTH);
    }
    retry->scene.depths = retry->depths;
    retry->scene.depth_count = hits;
    retry->scene.hit_share = (double)hits / (double)seen;
    retry->first_work = find_work(retry, plan, &plan->point);
    retry->unit_work =
        fmax(retry->first_work,
             (retry->scene.is_scattered ? PLAN_RETRY_LEAST_SCATTERED : PLAN_RETRY_LEAST) / retry->scene.pixels);
}

void plan_retry_spend(struct plan_retry *retry, const struct plan *plan, int width_px, int height_px)
{
    struct plan_scene scene = retry->scene;

    scene.pixels = (double)width_px * height_px;
    retry->spent_work += plan_family_work(&scene, &plan->quality) * scene.pixels / retry->scene.pixels;
}

double plan_retry_allowance(const struct plan_retry *retry)
{
    int next = retry->count < PLAN_RETRY_LIMIT ? retry->count : PLAN_RETRY_LIMIT - 1;

    return WORK_SO_FAR[next] * retry->unit_work - retry->spent_work;
}

int plan_retry_axes(const struct plan_retry *retry, const struct plan *plan,
                    enum plan_axis axes[static PLAN_AXIS_LIMIT])
{
    return plan_family_axes(&plan_families[plan->family], &retry->scene, axes);
}

static void set_point(const struct plan_retry *retry, struct plan *plan, const struct plan_point *point)
{
    plan->point = *point;
    plan->quality = plan_family_quality(&plan_families[plan->family], &retry->scene, point);
}

void plan_retry_vary(const struct plan_retry *retry, struct plan *plan, int axis)
{
    struct plan_point point = plan->point;

    point.rungs[axis] += point.rungs[axis] >= PLAN_HALVING_RUNGS ? -PLAN_HALVING_RUNGS : PLAN_HALVING_RUNGS;
    set_point(retry, plan, &point);
}

// Loops towards lights come first: they are within the others.
bool plan_retry_shorten(const struct plan_retry *retry, struct plan *plan, int rungs)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_retry_axes(retry, plan, axes);
    struct plan_point point = plan->point;
    bool moved = false;

    for (int outer = 0; outer < 2 && !moved; outer++)
        for (int i = 0; i < count; i++) {
            bool is_inner = axes[i] == PLAN_AXIS_LIGHT_STEP || axes[i] == PLAN_AXIS_DEPTH_STEP;
            bool is_outer = axes[i] == PLAN_AXIS_STEP || axes[i] == PLAN_AXIS_POINTS;

            if (!(outer ? is_outer : is_inner) || point.rungs[i] == 0) continue;
            point.rungs[i] -= rungs < point.rungs[i] ? rungs : point.rungs[i];
            moved = true;
        }
    if (moved) set_point(retry, plan, &point);
    return moved;
}

static bool is_noise(enum plan_axis axis)
{
    return axis == PLAN_AXIS_NODE_PATHS || axis == PLAN_AXIS_PIXEL_PATHS;
}

bool plan_retry_know(const struct plan_retry *retry, const struct plan *plan, double changes[static PLAN_AXIS_LIMIT])
{
    // Trials of few pixels say roughly which of the two is larger.
    static const double LEAST_PART = 0.25;
    double all = plan->cells_square + plan->paths_square, least = LEAST_PART * all;
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_retry_axes(retry, plan, axes);

    for (int i = 0; i < PLAN_AXIS_LIMIT; i++) {
        changes[i] = 0.0;
        if (i >= count) continue;
        if (axes[i] == PLAN_AXIS_SCATTER_GRID) changes[i] = sqrt(fmax(plan->cells_square, least));
        if (is_noise(axes[i])) changes[i] = sqrt(fmax(plan->paths_square, least));
    }
    return all > 0.0;
}

// Squared errors add up; what the changes leave unexplained is blamed on the axes in the same proportion.
static void blame(const double *changes, int count, double error, double errors[static PLAN_AXIS_LIMIT])
{
    double sum = 0.0;

    for (int i = 0; i < count; i++)
        sum += changes[i] * changes[i];
    for (int i = 0; i < count; i++)
        errors[i] = sum > 0.0 && isfinite(sum) ? error * changes[i] / sqrt(sum) : error / sqrt(count);
}

// An error is no less than its noise, which falls with the root of the paths, whatever else is refined.
static void note_noise(struct plan_retry *retry, const struct plan *plan, double error)
{
    double noise = error * sqrt(plan->quality.paths);

    if (plan->quality.paths == 0) return;
    if (retry->noise == 0.0 || retry->noise_family != plan->family || noise < retry->noise) retry->noise = noise;
    retry->noise_family = plan->family;
}

// What cannot be noise is blamed on the other axes, if there are any.
static void bound_noise(const struct plan_retry *retry, const struct plan *plan, const enum plan_axis *axes, int count,
                        double error, double errors[static PLAN_AXIS_LIMIT])
{
    double noise = 0.0, rest = 0.0, most = retry->noise / sqrt(fmax(plan->quality.paths, 1.0));

    for (int i = 0; i < count; i++)
        *(is_noise(axes[i]) ? &noise : &rest) += errors[i] * errors[i];
    if (!(most < error) || !(noise > most * most) || rest == 0.0) return;
    for (int i = 0; i < count; i++)
        errors[i] *= is_noise(axes[i]) ? most / sqrt(noise) : sqrt((error * error - most * most) / rest);
}

static double sum_up(const double *errors, int count)
{
    double sum = 0.0;

    for (int i = 0; i < count; i++)
        sum += errors[i] * errors[i];
    return sqrt(sum);
}

// Refines by one rung the axis that is most to blame of those that can be refined within `limit`.
static bool refine_worst(const struct plan_retry *retry, const struct plan *plan, struct plan_point *point,
                         double *errors, double limit)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_retry_axes(retry, plan, axes), worst = -1;

    for (int i = 0; i < count; i++) {
        struct plan_point next = *point;

        if (!(errors[i] > 0.0) || (worst >= 0 && errors[i] <= errors[worst])) continue;
        if (++next.rungs[i] > plan_axis_last_rung(axes[i], &retry->scene) || find_work(retry, plan, &next) > limit)
            continue;
        worst = i;
    }
    if (worst < 0) return false;
    point->rungs[worst]++;
    errors[worst] *= is_noise(axes[worst]) ? NOISE_FALL : FALL;
    return true;
}

// True where noise alone is expected to miss by far: how it falls is sure. A picture that may be published is as good
// as it can be.
static bool is_hopeless(const struct plan_retry *retry, const enum plan_axis *axes, const double *errors, int count)
{
    const struct job_quality *quality = &retry->scene.job->quality;

    for (int i = 0; i < count && quality->on_miss == JOB_ON_MISS_FAIL; i++)
        if (is_noise(axes[i]) && errors[i] > HOPELESS * quality->tolerance) return true;
    return false;
}

bool plan_retry_refine(struct plan_retry *retry, struct plan *plan, double changes[static PLAN_AXIS_LIMIT],
                       double error)
{
    double tolerance = retry->scene.job->quality.tolerance, errors[PLAN_AXIS_LIMIT] = {0.0};
    double limit = plan_retry_allowance(retry), all = PLAN_RETRY_WORK * retry->unit_work - retry->spent_work;
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count = plan_retry_axes(retry, plan, axes);
    struct plan_point point = plan->point;
    bool moved = false;

    blame(changes, count, isfinite(error) ? error : 1.0, errors);
    if (retry->scene.is_scattered && isfinite(error)) {
        note_noise(retry, plan, error);
        bound_noise(retry, plan, axes, count, error, errors);
    }
    while (sum_up(errors, count) > (retry->scene.is_scattered ? SCATTERED_GOAL : GOAL) * tolerance &&
           refine_worst(retry, plan, &point, errors, limit))
        moved = true;
    // A rendering of which a miss is expected is a waste: this one may take what is left.
    while (sum_up(errors, count) > tolerance && refine_worst(retry, plan, &point, errors, all))
        moved = true;
    if (!moved || (isfinite(error) && is_hopeless(retry, axes, errors, count))) return false;
    set_point(retry, plan, &point);
    memcpy(changes, errors, sizeof errors);
    return true;
}

// The rung of an axis that the family before may not have.
static int rung_like(const struct plan_retry *retry, const struct plan *plan, enum plan_axis wanted)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    enum { CELLS = 6, RANDOM_PATHS = 18 }; // where the family before has none
    int count = plan_retry_axes(retry, plan, axes), steps = 0;

    for (int i = 0; i < count; i++) {
        if (axes[i] == wanted) return plan->point.rungs[i];
        if (axes[i] == PLAN_AXIS_STEP) steps = plan->point.rungs[i];
    }
    if (wanted == PLAN_AXIS_SCATTER_GRID) return CELLS;
    return wanted == PLAN_AXIS_NODE_PATHS || wanted == PLAN_AXIS_PIXEL_PATHS ? RANDOM_PATHS : steps;
}

// False when no point that is at most DROP_LIMIT rungs coarser than the plan is within the allowance.
static bool enter_family(const struct plan_retry *retry, const struct plan *plan, size_t family, struct plan *entered)
{
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int count;

    *entered = *plan;
    entered->family = family;
    count = plan_retry_axes(retry, entered, axes);
    for (int drop = 0; drop <= DROP_LIMIT; drop++) {
        struct plan_point point = {.rungs = {0}};

        for (int i = 0; i < count; i++) {
            int last = plan_axis_last_rung(axes[i], &retry->scene), rung = rung_like(retry, plan, axes[i]) - drop;

            point.rungs[i] = rung < 0 ? 0 : rung > last ? last : rung;
        }
        if (find_work(retry, entered, &point) > plan_retry_allowance(retry)) continue;
        set_point(retry, entered, &point);
        return true;
    }
    return false;
}

bool plan_retry_change_family(struct plan_retry *retry, struct plan *plan)
{
    for (size_t step = 1; step < plan_family_count; step++) {
        size_t family = (plan->family + step) % plan_family_count;
        struct plan entered;

        if ((retry->tried >> family) % 2 == 1 || !plan_family_serves(&plan_families[family], &retry->scene)) continue;
        if (!enter_family(retry, plan, family, &entered)) continue;
        *plan = entered;
        retry->tried |= 1u << family;
        return true;
    }
    return false;
}

void plan_retry_settle(const struct plan_retry *retry, const struct plan *missed, double missed_error,
                       struct plan *found, double found_error)
{
    double settled = retry->scene.is_scattered ? SCATTERED_SETTLED : SETTLED;
    double wanted = settled * retry->scene.job->quality.tolerance, share;
    struct plan_point point = found->point;

    if (missed->family != found->family || !(found_error < wanted) || !(missed_error > wanted) || isinf(missed_error))
        return;
    share = log(missed_error / wanted) / log(missed_error / fmax(found_error, TINY));
    for (int i = 0; i < PLAN_AXIS_LIMIT; i++) {
        int finer = found->point.rungs[i] - missed->point.rungs[i];

        if (finer > 0) point.rungs[i] = missed->point.rungs[i] + (int)ceil(share * finer);
    }
    set_point(retry, found, &point);
}
