// Writes the part of a scene's shader that tracking asks: majorants, extinction at a point, estimated transmittance.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// For tracking, after scene_glue_write_media:
//   media_extinction(field)    per metre, at the field's point
// with majorants:
//   MediaRay, media_ray(origin, direction)     what majorants need of a ray: made once for all its cells
//   media_rate(spans, ray, at, least, edge)    a majorant of all media's extinction in each colour, valid from `at` to
//   `edge`, which it may shorten; at least `least` where some medium may be, 0 where there is none
// and if features.estimates_columns, what transmittance modules call:
//   media_column_none(), media_column_extinction(column)  extinction per metre of a column that is a metre long
//   media_column_rate(spans, ray, at, edge)  as media_rate, of the media that vary only
void scene_glue_write_tracking(FILE *out, const struct scene_model *model);
// `Spectrum media_transmittance_estimate(MediaSpans spans, vec3 origin, vec3 direction, vec2 interval, float step)`: an
// estimate of the transmittance of the media between two distances along a ray; `step` is for marches. It comes after
// the estimator's module.
void scene_glue_write_estimate(FILE *out, const struct scene_model *model);
