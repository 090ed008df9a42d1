// How fine a march has to be that brings scattered light from a grid, and the lights' grids that its walks look up.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/plan/plan_family.h"
#include "worker/render/renderer_fault.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct job;
struct plan;
struct plan_lattice;
struct plan_params;

struct scatter_march_params {
    const struct plan_lattice *lattice;
    const struct plan_params *params;
    const struct job *job; // of one sample
    int32_t frame;
    double light; // mean square of its pixels
    double most;  // relative RMSE that an axis may add
};

// A plan of the first order says little where its share of the light is small. Refines the axes of one that has a grid
// of scattered light, each until half the step, or twice as many cells, change a picture of all orders by no more than
// `most`. Both pictures have the same walks, so that no noise is in the change. Returns false with a fault where
// nothing can be rendered.
bool scatter_march_refine(const struct scatter_march_params *params, struct plan *plan, enum renderer_fault *fault,
                          struct error *error);

// True for an axis that the march has of its own, and for the lights' grids.
bool scatter_march_has(enum plan_axis axis);
// Gives a point so few cells and walks that its pictures tell of the march alone, quickly.
void scatter_march_lighten(const enum plan_axis *axes, int count, struct plan_point *point);
