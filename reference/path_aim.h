// Second paths towards where lamps' light comes from, for media that scatter in narrow lobes.
// SPDX-License-Identifier: Apache-2.0
// A vertex sees a lamp brightly only if its path flies along the lamp's light, into which a narrow lobe rarely turns.
// So some vertices send a second path whose first direction is drawn by the phase about a lamp, and which looks for
// that lamp alone at its next few vertices. Where media scatter backward, it begins away from the lamp: the next vertex
// turns the light back. What vertices see of a lamp counts by the balance heuristic over all ways in which they may
// have been found: Veach and Guibas, SIGGRAPH 1995.
#pragma once

#include "reference/path_light.h"
#include "reference/stream.h"

// Lamps are the still's lights, and its spheres after them.
size_t path_aim_count_lamps(const struct path_scene *scene);
// Looks from a vertex at the lamps: for each, the direction and the chance that the vertex sends a second path. They
// follow from places and directions alone, so that all ways to find a vertex know the same. A vertex that lies so deep
// that the lamp's light has been scattered often before it comes there sends none.
void path_aim_look(struct path_aim *aim, const struct path_scene *scene, const struct path_vertex *vertex);
// The direction in which a second path begins from the vertex that was looked from last.
struct vec3 path_aim_draw(const struct path_aim *aim, const struct path_vertex *vertex, size_t lamp,
                          struct stream *stream);
// Notes that a path goes on from that vertex along `direction`, however it was drawn.
void path_aim_note(struct path_aim *aim, const struct path_vertex *vertex, struct vec3 direction);
