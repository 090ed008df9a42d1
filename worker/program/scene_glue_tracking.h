// Writes the part of a scene's shader that tracking asks: majorants, extinction at a place, what is left after a way.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// Of scenes that are tracked, after scene_glue_write_media:
//   media_extinction(field)    per metre, where the field was taken
// and among majorants:
//   media_rate(spans, p, direction, at, least, edge)  a majorant of all media's extinction in each colour, valid up to `edge`,
//                              which it may shorten; at least `least` where any of them may be, 0 where there is none
// If features.estimates_columns, also what transmittance modules call:
//   media_column_none(), media_column_extinction(column)  of a column a metre long: per metre
//   media_column_rate(spans, p, direction, at, edge)  as media_rate, of the media that vary alone
void scene_glue_write_tracking(FILE *out, const struct scene_model *model);
// `Spectrum media_left(MediaSpans spans, vec3 origin, vec3 direction, vec2 way, float step)`: an estimate of what the media
// leave of light between two places on its way; `step` is for marches. After the module that estimates.
void scene_glue_write_left(FILE *out, const struct scene_model *model);
