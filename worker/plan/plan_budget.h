// The counted work that making a plan may take.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct plan_params;
struct plan_scene;

// Linking a program and making machine code of it, counted in evaluations. Linking takes 0.05 to 0.7 s of processor
// time for the examples (bench/pixel_list_bench), mostly 0.2 s, and an evaluation 2 to 5 ns.
static const double PLAN_LINK_WORK = 6e7;

// In evaluations of density, as plan_family_work counts them: 5 % of what the frames of the segment take with the
// settings at which the cheapest family's search may begin; or what two processors do in about a second, if that is
// more, or before the rays of `scene` are known. Equal jobs have equal budgets.
double plan_budget_find(const struct plan_params *params, const struct plan_scene *scene);
