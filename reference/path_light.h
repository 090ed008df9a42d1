// The light of lamps and domes that a path's vertex scatters.
// SPDX-License-Identifier: Apache-2.0
// Lamps with size and a dome's image are looked for in two ways, by directions towards them and by the path's next
// direction, and each counts by the balance heuristic: Veach and Guibas, SIGGRAPH 1995.
#pragma once

#include "reference/path_scene.h"
#include "reference/stream.h"

#include <stdbool.h>

// Where a path scatters. With neither medium nor surface it is the path's beginning.
struct path_vertex {
    struct vec3 position;
    struct vec3 incoming;        // direction of travel, away from the camera, of length 1
    const struct medium *medium; // that scatters here; borrowed; NULL: none
    bool is_surface;
    bool is_first;        // of a ray that is seen: no lamp is looked for seldom
    double turn;          // 1 less the mean cosine of what it scatters
    int aim_vertices;     // of second paths from here; 0: there are none
    struct vec3 normal;   // of a surface: of length 1, towards the path
    double throughput[3]; // with the share that is scattered, without the phase
};

// Other ways that look for lamps (reference/path_aim.h). The zero value is none.
struct path_aim {
    size_t lamp_count;                       // the still's lights, and its spheres after them; 0: no other way
    struct vec3 ways[2 * SCENE_LIGHT_LIMIT]; // to the lamps, from the vertex that was looked from last
    double chances[2 * SCENE_LIGHT_LIMIT];   // that it sends a second path
    int next;                                // of the following, that was noted last
    int left[PATH_AIM_VERTICES];             // vertices for which it still holds
    // By how much more densely they are found in the other way, by the vertex before them at which the ways part.
    double ratios[PATH_AIM_VERTICES][2 * SCENE_LIGHT_LIMIT];
};

// Per steradian: how a vertex scatters into `direction`, and at the same time how densely directions are drawn.
double path_vertex_scatter(const struct path_vertex *vertex, struct vec3 direction);
// A direction in which a path goes on.
struct vec3 path_vertex_draw(const struct path_vertex *vertex, struct stream *stream);

// Adds the light of all lamps and domes, less the shares that belong to the vertex before (reference/path_peak.h),
// those that the path's next direction brings, and those of other ways to find the vertex. A lamp without a peak from
// which the vertex scatters little is looked for at random, and counts the more: Russian roulette, Arvo and Kirk,
// SIGGRAPH 1990.
void path_light_add(const struct path_scene *scene, const struct path_vertex *vertex, const struct path_aim *aim,
                    struct stream *stream, double radiance[static 3]);
// The same of one lamp alone: the still's lights, and its spheres after them.
void path_light_add_one(const struct path_scene *scene, const struct path_vertex *vertex, const struct path_aim *aim,
                        size_t lamp, struct stream *stream, double radiance[static 3]);
// Adds `share` of the light of one of the still's lights, or of all that one of its spheres brings.
void path_light_add_lamp(const struct path_scene *scene, const struct path_vertex *vertex, size_t lamp, double share,
                         struct stream *stream, double radiance[static 3]);
void path_light_add_sphere(const struct path_scene *scene, const struct path_vertex *vertex, size_t sphere,
                           double share, struct stream *stream, double radiance[static 3]);

// The share of what a vertex sees of a lamp that counts, by the other ways to find the vertex.
double path_light_aimed_share(const struct path_aim *aim, size_t lamp);
// The share of the light that counts where a drawn direction meets a sphere, or the dome behind all.
double path_light_sphere_share(const struct path_scene *scene, const struct path_vertex *vertex, size_t sphere,
                               struct vec3 direction);
double path_light_dome_share(const struct path_scene *scene, const struct path_vertex *vertex, struct vec3 direction);
