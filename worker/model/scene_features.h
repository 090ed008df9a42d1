// Which parts of a scene a picture can show, and so are modelled; the rest costs nothing.
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
    bool is_tabled; // of its values at both ends of a segment
    bool glows;     // as a black body
    bool has_falloff;
    bool is_even;                              // its density is the same throughout its region
    enum lobe_feature lobes[SCENE_LOBE_LIMIT]; // as many as the medium has; none: isotropic
};

struct scene_features {
    struct medium_features media[SCENE_MEDIUM_LIMIT];
    size_t medium_count; // as the scene has, seen or not
    struct object_features objects[SCENE_OBJECT_LIMIT];
    size_t object_count;
    bool light_is_seen[SCENE_LIGHT_LIMIT]; // it shines, and something scatters or is diffuse
    bool has_media, has_lights, has_emission;
    bool has_objects;
    bool media_are_lit, surfaces_are_lit;
    bool has_extinction;    // some medium scatters or absorbs
    bool has_throughput;    // so rays carry what is left of them; also where surfaces change it
    bool takes_time;        // some medium's density is given the time
    bool marches;           // camera rays take steps; else each stretch between edges of media is one segment
    bool marches_to_lights; // so do shadow rays; else columns are known in closed form
    bool has_light_grids;   // instead of shadow rays: their columns are looked up in a grid of each light
    bool places_points;     // light of a whole stretch is gathered at points placed for each light
    bool is_rgb;            // something seen has a colour
    bool extinction_is_rgb; // media take more of one colour than of another
    bool has_depth, has_transmittance, has_background;
    bool has_paths;       // some rays are reflected or refracted: followed, counted and perhaps cut
    bool has_two_paths;   // some surface sends two rays on
    bool has_dielectrics; // light goes on in some object
    bool has_fresnel;     // which share some surface reflects follows from the angle
    bool has_roughness;
    bool has_samples;       // each pixel has several
    bool has_roulette;      // rays with little left end by lot
    bool has_peaks;         // segments are looked at in single points, and some light has a peak that these may miss
    bool is_jittered;       // each segment is looked at somewhere in it
    bool is_tabled;         // some medium is
    bool is_adaptive;       // segments are bounded by their optical depth
    bool is_gauss;          // segments are looked at in several nodes
    bool is_tracked;        // light is estimated, each part right on the average or nearly so
    bool has_majorants;     // so by free flights among a majorant of each medium; else by marches
    bool estimates_columns; // media that vary leave an estimated share of light on some ways
    bool is_sliced;         // the picture is drawn in slices, each as far as rays come at once
    bool is_random;         // something is drawn by lot
};

// `is_unneeded` (SCENE_MEDIUM_LIMIT of them; NULL: none) says which media the picture does without.
struct scene_features scene_features_of(const struct job *job, const bool *is_unneeded);
// True when its picture can be drawn in slices.
bool scene_features_can_be_sliced(const struct scene_features *features);
size_t scene_features_count_lights(const struct scene_features *features); // those that are seen
// True when something of it attenuates light.
bool medium_features_have_column(const struct medium_features *medium);
// True when the way of light through it has no closed form.
bool medium_features_march_to_lights(const struct medium_features *medium);
