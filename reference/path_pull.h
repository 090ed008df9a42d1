// How much light of lamps a path may still find, as it seems from where it is: near lamps inside, it is split.
// SPDX-License-Identifier: Apache-2.0
// It tells how many paths go on, never how much light there is: importance, Goertzel and Kalos, Monte Carlo Methods in
// Transport Problems, Progress in Nuclear Energy 2, 1958. Here it is what diffusion leaves of a lamp's light at a
// distance, in a box of the mean extinction of the medium that holds the lamp: at most PATH_PULL_MOST times as much as
// where the path was first scattered, since media may be far from even.
#pragma once

#include "core/scene/scene.h"
#include "reference/box.h"

#include <stddef.h>

static const double PATH_PULL_MOST = 256.0;

struct path_pull_lamp {
    struct vec3 position;
    double power; // W
    double fall;  // of its light, per metre
};

// The zero value has no lamps.
struct path_pull {
    struct path_pull_lamp lamps[2 * SCENE_LIGHT_LIMIT];
    size_t count;
};

// The fall in a medium of this extinction, less what goes straight on, and absorption, per metre; light leaks out of
// the box, whose sides may be INFINITY.
double path_pull_fall(double extinction, double absorption, const struct box *box);
void path_pull_add(struct path_pull *pull, const struct path_pull_lamp *lamp);
// Any scale; 0: there is no lamp, or none that matters.
double path_pull_at(const struct path_pull *pull, struct vec3 position);
// How many times as great it is at a position as where it was `first`: 1 at least.
double path_pull_growth(const struct path_pull *pull, struct vec3 position, double first);
