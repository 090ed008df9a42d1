// The counted work that making a plan may take.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct plan_params;

// In evaluations of density, as plan_family_work counts them: 5 % of what the frames of the segment take at the least,
// or what two processors do in about a second, whichever is more. Equal jobs have equal budgets.
double plan_budget_find(const struct plan_params *params);
