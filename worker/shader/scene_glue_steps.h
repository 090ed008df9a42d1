// Writes what marches by other rules than the midpoint rule ask of the media.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// After the media's own functions. Where segments are bounded by their optical depth:
//   media_extinction(field)                    extinction of the media there, per metre
//   media_column_none()                        an empty column
//   media_column_extend(column, rate, length)  adds `length` metres at `rate` per metre
//   media_column_thickness(column)             optical depth of the strongest colour
// and where segments have several nodes, the rule:
//   GAUSS_ORDER, GAUSS_NODES, GAUSS_WEIGHTS, GAUSS_PARTIALS   as in gauss_legendre.h
void scene_glue_write_steps(FILE *out, const struct scene_model *model);
// Writes `const float NAME[count]`.
void scene_glue_write_numbers(FILE *out, const char *name, const double *numbers, int count);
