// A still prepared for random paths: bounds of its media, samplers of its lights.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/dome_sampler.h"
#include "reference/majorant.h"
#include "reference/path_depth.h"
#include "reference/path_pull.h"
#include "reference/still.h"

#include <stdbool.h>
#include <stddef.h>

struct error;

// The most vertices at which a second path looks for its lamp (reference/path_aim.h).
enum { PATH_AIM_VERTICES = 16 };

// A medium of the air as paths see it.
struct path_medium {
    const struct medium *medium; // borrowed
    struct majorant majorant;    // of its density
    double sigma;                // tentative collisions per metre and unit of density: at least its extinctions
    double g;                    // of its narrowest lobe
    double turn;                 // 1 less the mean cosine of its phase
    bool glows;                  // it has a source of its own
    int aim_vertices;            // of second paths that begin here; 0: there are none, for it scatters widely
};

// A place about which light grows without limit: a lamp's. Within `reach` of it (m; 0: nowhere) paths look for the
// lamp's light from the vertex before, too.
struct path_peak {
    struct vec3 position;
    const struct light *spot; // borrowed from the still; NULL: it shines in all directions
    double reach;
};

struct path_scene {
    const struct still *still; // borrowed; outlives us
    struct path_medium media[SCENE_MEDIUM_LIMIT];
    size_t medium_count;
    struct path_peak peaks[SCENE_LIGHT_LIMIT];        // of the still's lights
    struct path_peak sphere_peaks[SCENE_LIGHT_LIMIT]; // of its spheres
    struct dome_sampler dome;
    struct path_pull pull;            // of lamps inside of media
    struct path_depth depth;          // where there are narrow lobes
    const struct path_medium *narrow; // the medium of the narrowest lobe; NULL: all scatter widely
    int orders;                       // light of lamps and domes is scattered at most so often, >= 1
};

// False with an error that says which part of the still paths cannot follow: mirrors, dielectrics, specular surfaces,
// a density without a known bound, and media without end that absorb nothing.
bool path_scene_is_possible(const struct still *still, struct error *error);
// The still, for which that is true, outlives the scene. The caller passes it to path_scene_finish.
void path_scene_init(struct path_scene *scene, const struct still *still, int orders);
void path_scene_finish(struct path_scene *scene);

// How much of a lamp's light at a position belongs to the look from the vertex before; the rest is the position's own:
// it falls smoothly from 1 at the lamp to 0 at its reach.
double path_peak_share(const struct path_peak *peak, struct vec3 position);
