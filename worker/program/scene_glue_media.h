// Writes the part of a scene's shader that asks its media: where a ray meets them, what is at a point, columns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdio.h>

struct scene_model;

// The functions of each seen medium's density and bounds, then what integrator modules call:
//   MediaSpans            distances between which a ray is inside each medium
//   media_spans(origin, direction), media_spans_from(spans, start): the same, counted from `start` on
//   media_spans_in(spans, region, piece)  where there are objects: those of the region's media on a piece of the ray
//   media_interval(spans) first entry and last exit
//   media_next_edge(spans, at, end)   the nearest entry or exit beyond `at`, at most `end`
//   MediaField            what the media have at a point; .distance < 0 where there may be density, else how far along the
//                         ray there is none; .medium_I the density's own field; .medium_I_share, where there is one: 0
//                         outside the span, else the falloff
//   media_field(spans, p, direction, at)  `p` lies `at` along the ray
// and if shadows are cast what transmittance modules call:
//   MediaColumn           density integrated along a way, a number a medium
//   media_column_begin(spans, distance)   with media of even density already in it, to `distance`
//   media_column_interval(spans), media_column_next_edge(spans, at, end)  as above, of those that are not
//   media_column_add(column, spans, p, direction, at, length)  adds these; returns what .distance is above
//   media_column_depth(column), media_transmittance(column)
void scene_glue_write_media(FILE *out, const struct scene_model *model);
// Of all this the part that a march for columns alone calls, which is all but media_field, media_column_depth and
// media_transmittance.
void scene_glue_write_columns(FILE *out, const struct scene_model *model);
// media_column_none(), a column of nothing.
void scene_glue_write_column_none(FILE *out, const struct scene_model *model);
// The expression of a medium's rho from `MediaField field`.
void scene_glue_write_density(FILE *out, const struct scene_model *model, size_t medium);
