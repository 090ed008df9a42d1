// Random estimates of the light that passes a straight way, for all colours by the same draws.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/path_scene.h"
#include "reference/stream.h"

// Multiplies `light` by an unbiased estimate of the transmittance of the ray from its origin to `distance`, which may
// be INFINITY: by ratio tracking (Novak, Selle and Jarosz, Residual Ratio Tracking, SIGGRAPH Asia 2014), in closed form
// where a medium is even. Opaque objects leave nothing. Light that has become weak is ended at random.
void path_passage_attenuate(const struct path_scene *scene, const struct ray *ray, double distance,
                            struct stream *stream, double light[static 3]);
