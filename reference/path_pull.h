// How much light of lamps a path may still find, as it seems from where it is: near lamps inside, it is split.
// SPDX-License-Identifier: Apache-2.0
// It tells how many paths go on, never how much light there is: importance, Goertzel and Kalos, Monte Carlo Methods in
// Transport Problems, Progress in Nuclear Energy 2, 1958. Here it is what diffusion leaves of a lamp's light at a
// distance, in a box of the media's mean extinction.
#pragma once

#include "core/scene/scene.h"
#include "reference/box.h"

#include <stddef.h>

// The zero value has no lamps.
struct path_pull {
    struct vec3 lamps[2 * SCENE_LIGHT_LIMIT];
    double powers[2 * SCENE_LIGHT_LIMIT]; // W
    size_t count;
    double fall; // per metre
};

void path_pull_add(struct path_pull *pull, struct vec3 lamp, double power_w);
// The fall in media of this extinction, less what goes straight on, and absorption, per metre; light leaks out of the
// box, whose sides may be INFINITY.
void path_pull_set_fall(struct path_pull *pull, double extinction, double absorption, const struct box *box);
// Any scale; 0: there is no lamp.
double path_pull_at(const struct path_pull *pull, struct vec3 position);
