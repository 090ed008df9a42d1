// Writes the part of a scene's shader that follows rays from surface to surface, and light to where it is seen.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdio.h>

struct scene_model;

// `Spectrum shadow(point, light, inside, left)`: what objects and media leave of a light on the straight way to a point;
// `inside` and `left` as a PathRay has them.
void scene_glue_write_shadow(FILE *out, const struct scene_model *model);
// PATH_DEPTH_LIMIT, PATH_THROUGHPUT_LIMIT and what the sample has seen so far: path_radiance, path_behind, path_depth.
void scene_glue_write_seen(FILE *out, const struct scene_model *model);
// What shaders/path/ calls: path_gather(ray, end), path_answer(ray, hit), path_escape(ray).
void scene_glue_write_path(FILE *out, const struct scene_model *model);
// In main(), after `camera`, `toward` and `direction` are known.
void scene_glue_write_path_start(FILE *out, const struct scene_model *model);
