// Writes the part of a scene's shader that follows rays from surface to surface, and shadow rays.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// `Spectrum shadow(point, light, inside, left)`: the transmittance of objects and media on the straight line from a
// light to a point. `inside` and `left` are as in PathRay.
void scene_glue_write_shadow(FILE *out, const struct scene_model *model);
// `Spectrum surface_albedo(object, point, shape)`: the objects being numbered from 1 on.
void scene_glue_write_albedo(FILE *out, const struct scene_model *model);
// PATH_ROOM and the sample's sums so far: path_radiance, path_behind, path_depth.
void scene_glue_write_seen(FILE *out, const struct scene_model *model);
// Writes what shaders/path/ calls: path_gather(ray, end), path_answer(ray, hit), path_escape(ray).
void scene_glue_write_path(FILE *out, const struct scene_model *model);
// Writes the first ray of main(), after `camera`, `toward` and `direction` are known.
void scene_glue_write_path_start(FILE *out, const struct scene_model *model);
