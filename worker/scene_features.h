// Which parts of a scene a picture can show, and so are modelled; the rest costs nothing.
#pragma once

#include "core/scene.h"

#include <stdbool.h>

struct job;

struct medium_features {
    bool is_seen; // it scatters, absorbs or emits
    bool scatters, absorbs, emits;
};

struct scene_features {
    struct medium_features media[SCENE_MEDIUM_LIMIT];
    bool light_is_seen[SCENE_LIGHT_LIMIT]; // it shines, and something scatters
    bool has_media, has_lights, has_emission;
    bool has_extinction; // some medium scatters or absorbs
    bool is_rgb;         // something seen has a colour
    bool has_depth, has_transmittance, has_background;
};

struct scene_features scene_features_of(const struct job *job);
