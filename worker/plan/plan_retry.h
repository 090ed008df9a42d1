// The settings of a frame that is rendered again because it is over its tolerance.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/plan/plan.h"
#include "worker/plan/plan_family.h"

#include <stdbool.h>

struct image;

enum { PLAN_RETRY_LIMIT = 3, PLAN_RETRY_DEPTHS = 256 };

// The work of all renderings after the first, relative to it, as plan_family_work counts it; or to PLAN_RETRY_LEAST
// evaluations in the whole frame, if it took fewer: in a small picture most of the little work is light grids, which
// eight times as much refines by no more than a halving. Above order 1, PLAN_RETRY_LEAST_SCATTERED: a plan traces as
// much to find what is cheap, and a first rendering that took less says little of what the frame is worth.
static const double PLAN_RETRY_WORK = 8.0, PLAN_RETRY_LEAST = 1e7, PLAN_RETRY_LEAST_SCATTERED = 1e8;

// The account of one frame. Init with plan_retry_init.
struct plan_retry {
    struct plan_scene scene; // its depths are of the frame itself
    float depths[PLAN_RETRY_DEPTHS];
    double first_work, spent_work; // per pixel; the work that is spent is without the first rendering
    double unit_work;              // per pixel; the limits are multiples of it
    int count;                     // of renderings after the first
    unsigned tried;                // families, a bit each: the first rendering's, and those moved to
    // That of one path of each node or pixel, at most, as the errors of a family's renderings have it; 0: not known.
    double noise;
    size_t noise_family;
};

// Counts the rays of the first rendering, which was made with `plan`. Where that has no image (NULL), one of optical
// depth 1 stands for all. `job` outlives the account, which keeps its
// address.
void plan_retry_init(struct plan_retry *retry, const struct job *job, const struct image *image,
                     const struct plan *plan);
// Adds a rendering of `width_px` x `height_px` pixels to the account.
void plan_retry_spend(struct plan_retry *retry, const struct plan *plan, int width_px, int height_px);
// The work that the next rendering may take, per pixel. It grows from rendering to rendering.
double plan_retry_allowance(const struct plan_retry *retry);

// The axes of the plan's family; returns their number.
int plan_retry_axes(const struct plan_retry *retry, const struct plan *plan,
                    enum plan_axis axes[static PLAN_AXIS_LIMIT]);
// Makes one axis coarser by PLAN_HALVING_RUNGS, or finer where it is too coarse for that. The frame's change tells how
// much of its error is to be blamed on the axis.
void plan_retry_vary(const struct plan_retry *retry, struct plan *plan, int axis);
// Sets `changes` by what the plan knows of its grid of scattered light. False when it knows nothing.
bool plan_retry_know(const struct plan_retry *retry, const struct plan *plan, double changes[static PLAN_AXIS_LIMIT]);
// Refines the axes that are to be blamed until an error of half the tolerance is expected, of 0.8 of it with more than
// one order of scattering, or the allowance is spent: `changes` has an RMSE for each axis, and becomes what to expect
// afterwards. Errors are expected to fall with the steps to the power of 1.5, noise with the root of the paths. All
// axes are to blame where no change is known, and noise for no more than more paths leave of any error before: how it
// falls is sure. False when nothing can be refined, or where the noise that the allowance leaves is expected to be
// twice the tolerance, unless misses are published.
bool plan_retry_refine(struct plan_retry *retry, struct plan *plan, double changes[static PLAN_AXIS_LIMIT],
                       double error);
// Makes loops shorter that GL cut: the steps of rays towards lights coarser by `rungs`, or else those of the camera's.
// False when nothing can be coarser.
bool plan_retry_shorten(const struct plan_retry *retry, struct plan *plan, int rungs);
// Moves to the next family that serves the scene and was not tried, with the same rungs where they are within the
// allowance, else coarser ones. False when there is none.
bool plan_retry_change_family(struct plan_retry *retry, struct plan *plan);

// Turns a plan that keeps the tolerance into the one for later frames. Where it is finer than needed, it moves back
// towards `missed`, a plan of the same family that does not keep it, to the rungs at which 0.65 of the tolerance is to
// be expected, or 0.85 with more than one order of scattering: logarithms of errors fall evenly between the two.
void plan_retry_settle(const struct plan_retry *retry, const struct plan *missed, double missed_error,
                       struct plan *found, double found_error);
