// Writes what marches of other rules than the midpoint's ask of the media.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// After the media's own functions. Where segments are bounded by their optical depth:
//   media_extinction(field)     what the media there extinguish per metre
//   media_column_none()         a column of nothing
//   media_column_extend(column, rate, length)     adds `length` of what `rate` has a metre
//   media_column_thickness(column)      its optical depth by the strongest colour
// and where they are looked at in several nodes, the rule:
//   GAUSS_ORDER, GAUSS_NODES, GAUSS_WEIGHTS, GAUSS_PARTIALS     as gauss_legendre.h has them
void scene_glue_write_steps(FILE *out, const struct scene_model *model);
// `const float NAME[count]`.
void scene_glue_write_numbers(FILE *out, const char *name, const double *numbers, int count);
