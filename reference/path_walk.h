// One random path through a still: an unbiased estimate of the radiance that arrives along a ray.
// SPDX-License-Identifier: Apache-2.0
// Delta tracking through bricks of majorants, each medium by itself; the colours share all draws, by weights that know
// the path's history: Kutz et al., Spectral and Decomposition Tracking for Rendering Heterogeneous Volumes, SIGGRAPH
// 2017; Miller, Georgiev and Jarosz, A Null-Scattering Path Integral Formulation of Light Transport, SIGGRAPH 2019.
#pragma once

#include "reference/path_light.h"
#include "reference/stream.h"

struct path_walk {
    struct ray ray; // from its origin, against the light's travel
    // Instead of the ray: its direction is drawn as this vertex scatters, and the estimate is the mean radiance that
    // the vertex receives, weighted by its phase. Its throughput is 1. Borrowed; NULL: the ray.
    const struct path_vertex *from;
    double near, far; // m: media of the first stretch count between them; far may be INFINITY
    bool is_seen;     // emission and the looks at order 1 as a camera sees them: a dome or a sphere met at once is not
                      // counted. Else the ray is as one that has been scattered: all that it meets counts.
    // Called at each collision that scatters, and at each surface; NULL: nobody watches. `order` counts from 1,
    // `throughput` is that after it.
    void (*on_vertex)(void *user, int order, struct vec3 position, const double throughput[static 3]);
    void *user;
    // Light that is scattered more often than `parted` times, and emitted light not once less, is added here instead;
    // NULL: all of it is added to `radiance`. The draws are the same.
    double *beyond; // 3
    int parted;
    // How deep the bounds of the scene's media are along the ray, of which no path then misses all: it collides at
    // least once, and counts as much less as that is likely. path_walk_force sets both.
    bool is_forced;
    double depths[SCENE_MEDIUM_LIMIT];
    // The path is given up, its estimate being worth nothing, once it has drawn more numbers; 0: never.
    uint64_t draws_most;
};

// Forces the first tentative collision of a ray that is seen, unless it ends in a surface, meets nothing or collides
// almost surely: few paths would collide in a thin medium. `throughput` of on_vertex is then that of a path that does.
void path_walk_force(const struct path_scene *scene, struct path_walk *walk);
// Adds one path's estimate to `radiance`: light scattered at most scene->orders times, and what glows at most orders -
// 1 times; without the background and, for a ray that is seen, without the dome behind the still. Returns the number of
// looks at densities.
long path_walk_add(const struct path_scene *scene, const struct path_walk *walk, struct stream *stream,
                   double radiance[static 3]);
