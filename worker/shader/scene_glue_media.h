// Writes the part of a scene's shader that asks its media: spans on a ray, fields at a point, columns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdio.h>

struct scene_model;

// Writes the functions of each visible medium's density and bounds, then what integrator modules call:
//   MediaSpans            distances between which a ray is inside each medium
//   media_spans(origin, direction), media_spans_from(spans, start): the same, counted from `start` on
//   media_spans_in(spans, region, piece)  where there are objects: those of the region's media on a piece of the ray
//   media_interval(spans) first entry and last exit
//   media_next_edge(spans, at, end)   the nearest entry or exit beyond `at`, at most `end`
//   MediaField            fields of the media at a point: .medium_I the density's own; .medium_I_share, where there is
//                         one, 0 outside of the span, else the falloff; .distance < 0 where there may be density, else
//                         how far along the ray there is none
//   media_field(spans, p, direction, at)  `p` lies `at` along the ray
// and, where there are shadows, what transmittance modules call:
//   MediaColumn           density integrated along a ray, a number a medium
//   media_column_begin(spans, distance)   the column of homogeneous media, up to `distance`
//   media_column_interval(spans), media_column_next_edge(spans, at, end)  as above, of the other media
//   media_column_add(column, spans, p, direction, at, length)  adds the other media; returns a distance as above
//   media_column_depth(column), media_transmittance(column)
void scene_glue_write_media(FILE *out, const struct scene_model *model);
// Writes the part of this that a march for columns calls: all but media_field, media_column_depth, media_transmittance.
void scene_glue_write_columns(FILE *out, const struct scene_model *model);
// Writes media_column_none(), an empty column.
void scene_glue_write_column_none(FILE *out, const struct scene_model *model);
// Writes the expression of a medium's rho from `MediaField field`.
void scene_glue_write_density(FILE *out, const struct scene_model *model, size_t medium);
