// The parts of a scene that a picture can show, and so are modelled. The rest costs nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene/scene.h"
#include "worker/model/object_features.h"

#include <stdbool.h>

struct job;

enum lobe_feature {
    LOBE_UNSEEN,    // its weight is 0
    LOBE_ISOTROPIC, // its g is 0
    LOBE_HENYEY_GREENSTEIN,
    LOBE_RAYLEIGH
};

struct medium_features {
    bool is_seen; // it scatters, absorbs or emits
    bool scatters, absorbs, emits;
    bool has_color; // a transfer function gives extinction and source
    bool is_tabled; // its values come from a table, by both ends of a segment
    bool glows;     // as a black body
    bool has_falloff;
    bool is_even;                              // homogeneous: its density is the same throughout its region
    enum lobe_feature lobes[SCENE_LOBE_LIMIT]; // as many as the medium has; none: isotropic
};

struct scene_features {
    struct medium_features media[SCENE_MEDIUM_LIMIT];
    size_t medium_count; // of the scene, visible or not
    struct object_features objects[SCENE_OBJECT_LIMIT];
    size_t object_count;
    bool light_is_seen[SCENE_LIGHT_LIMIT];    // it is not black, and something scatters or is diffuse
    bool light_is_marched[SCENE_LIGHT_LIMIT]; // it is seen, and not from many directions at once
    bool has_media, has_lights, has_emission;
    bool has_objects;
    bool media_are_lit, surfaces_are_lit;
    bool has_extinction;    // some medium scatters or absorbs
    bool has_throughput;    // rays carry a throughput: media or surfaces change it
    bool takes_time;        // some medium's density is a function of time
    bool marches;           // camera rays march; else each stretch between edges of media is one segment
    bool marches_to_lights; // so do shadow rays; else columns have a closed form
    bool has_light_grids;   // instead of shadow rays, each light that marches go to has a grid of columns
    bool places_points;     // light is gathered over a whole stretch, at points placed for each light
    bool is_rgb;            // something visible has a colour
    bool extinction_is_rgb; // extinction depends on the colour
    bool has_depth, has_transmittance;
    bool has_background;  // what lies behind everything is not black
    bool dome_is_behind;  // it is a dome
    bool has_rays;        // something is seen along camera rays
    bool has_paths;       // some rays are reflected or refracted; they are counted, and may be cut
    bool has_two_paths;   // some surface both reflects and refracts
    bool has_dielectrics; // some object is transparent
    bool has_fresnel;     // the reflected share of some surface follows from the angle
    bool has_roughness;
    bool has_samples;       // several samples a pixel
    bool has_roulette;      // rays of low throughput end at random
    bool has_peaks;         // segments are evaluated at single points, and some light has a peak that these may miss
    bool is_jittered;       // each segment is evaluated at a random point of it
    bool is_tabled;         // some medium is tabled
    bool is_adaptive;       // segments are bounded by their optical depth
    bool is_gauss;          // segments are evaluated at several nodes
    bool is_tracked;        // light is a random estimate, unbiased or nearly so
    bool has_majorants;     // estimated by free flights among a majorant of each medium; else by marches
    bool estimates_columns; // the transmittance of media that vary is estimated
    bool is_walked;         // light comes by random paths of any number of scatterings, among majorants
    // So does the transmittance from a path's vertex to a light that has no grid; else it has a closed form.
    bool tracks_to_lights;
    bool is_scattered;     // the picture is the layer of scattered light alone (core/job/job_layers.h)
    bool is_sliced;        // the picture is drawn in slices: each goes as far as the driver lets loops run
    bool is_random;        // something uses random numbers
    bool has_scatter_grid; // light that was scattered before comes from a grid
    bool fills_grid;       // the program shows no picture: it fills that grid
};

// `is_unneeded` (SCENE_MEDIUM_LIMIT of them; NULL: none) says which media the picture leaves out.
struct scene_features scene_features_of(const struct job *job, const bool *is_unneeded);
// True when the picture can be drawn in slices.
bool scene_features_can_be_sliced(const struct scene_features *features);
size_t scene_features_count_lights(const struct scene_features *features);  // visible ones
size_t scene_features_count_marched(const struct scene_features *features); // those that marches go to
// True when the medium attenuates light.
bool medium_features_have_column(const struct medium_features *medium);
// True when the medium's column has no closed form.
bool medium_features_march_to_lights(const struct medium_features *medium);
