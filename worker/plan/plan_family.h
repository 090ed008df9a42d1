// The families of settings that a plan chooses among: the scenes that each serves, its axes, and its work.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/plan/plan_search.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum plan_axis {
    PLAN_AXIS_STEP,
    PLAN_AXIS_LIGHT_STEP,
    PLAN_AXIS_DEPTH_STEP,
    PLAN_AXIS_POINTS,
    PLAN_AXIS_LIGHT_GRID,
    PLAN_AXIS_DENSITY_GRID,
    PLAN_AXIS_MIN_TRANSMITTANCE,
    PLAN_AXIS_PATHS, // max_depth and min_throughput
    // Of scenes that scatter light more than once. They stand last: a plan for the first order alone lacks them.
    PLAN_AXIS_SCATTER_GRID,
    PLAN_AXIS_NODE_PATHS, // random paths of each node of the scatter_grid
    PLAN_AXIS_PIXEL_PATHS // random paths of each pixel
};

// The properties of a scene on which axes and work depend.
struct plan_scene {
    const struct job *job; // borrowed
    bool counts_voxels;    // steps are in voxels, because there is a grid
    double path_length;    // of the longest path that is marched, in metres, or in voxels where these are counted
    // Of the paths by which work is counted, in the same unit: a ball's diameter where a ball is all that there is, and
    // half of it towards lights.
    double camera_length, light_length;
    int small_level; // by how many halvings steps for the smallest medium are shorter than those for the longest path
    bool is_even;    // all media are homogeneous without falloff
    // has_lights: those that a march shows.
    bool has_media, has_lights, has_extinction, has_paths, has_roughness;
    bool is_scattered;   // light is scattered more than once
    double path_flights; // mean number of flights of a random path
    const float *depths; // borrowed; optical depths, one for each measured ray that meets a medium
    size_t depth_count;
    double hit_share; // of the measured rays: those that meet a medium
    double pixels;    // of the frame
};

struct plan_family {
    const char *name;
    enum job_method method;
    int order; // gauss
    bool (*serves)(const struct plan_scene *scene);
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int axis_count;
};

// Leaves the depths empty, which a pilot measures, and takes all paths for the longest. `job` outlives the scene.
void plan_scene_init(struct plan_scene *scene, const struct job *job);
// Finds how long the paths in these frames are.
void plan_scene_measure_lengths(struct plan_scene *scene, const int32_t *frames, int frame_count);

extern const struct plan_family plan_families[];
extern const size_t plan_family_count;

// True when the family's method renders this scene.
bool plan_family_serves(const struct plan_family *family, const struct plan_scene *scene);
// Writes the axes that have an effect in this scene and returns their number.
int plan_family_axes(const struct plan_family *family, const struct plan_scene *scene,
                     enum plan_axis axes[static PLAN_AXIS_LIMIT]);
int plan_axis_last_rung(enum plan_axis axis, const struct plan_scene *scene);
// A point of the family as a job's quality, with the job's own samples and tolerance.
struct job_quality plan_family_quality(const struct plan_family *family, const struct plan_scene *scene,
                                       const struct plan_point *point);
// Adds the steps of the march that shows what is seen directly beside random paths (core/job/job_layers.h): fine ones,
// since it meets no light but what media emit. There are none where a march has no end.
void plan_family_add_seen(const struct plan_scene *scene, struct job_quality *quality);

// The point at which a search begins whose pilot agrees after `level` halvings of all steps.
struct plan_point plan_family_start(const struct plan_family *family, const struct plan_scene *scene, int level);

// Evaluations of density per pixel, counted from the numbers alone; a lookup in a texture counts as part of one.
double plan_family_work(const struct plan_scene *scene, const struct job_quality *quality);
