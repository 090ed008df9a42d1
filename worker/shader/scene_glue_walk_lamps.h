// Writes the lamps whose light that reaches a vertex of random paths is known there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdio.h>

struct scene_model;

// Whether there are such lamps, above order 1: those of all lights that are marched, or none.
bool scene_glue_walk_knows_lamps(const struct scene_model *model);
// Where there are, after scene_glue_write_walk_lights:
//   WALK_LAMPS                        their number
//   walk_lamp_draw()                  the index of one of them, each as likely
//   walk_lamp_seen(lamp, point, passed)  the lamp as a vertex in the media sees it; sets the share of its light that
//                                     reaches the vertex
void scene_glue_write_walk_lamps(FILE *out, const struct scene_model *model);
