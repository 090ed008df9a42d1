// The methods that a plan chooses among: whom each serves, what of it can be finer or coarser, and what it costs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"
#include "worker/plan/plan_search.h"

#include <stdbool.h>
#include <stddef.h>

enum plan_axis {
    PLAN_AXIS_STEP,
    PLAN_AXIS_LIGHT_STEP,
    PLAN_AXIS_DEPTH_STEP,
    PLAN_AXIS_POINTS,
    PLAN_AXIS_LIGHT_GRID,
    PLAN_AXIS_DENSITY_GRID,
    PLAN_AXIS_MIN_TRANSMITTANCE,
    PLAN_AXIS_PATHS // max_depth and min_throughput
};

// What of a scene decides the axes and the work.
struct plan_scene {
    const struct job *job; // borrowed
    bool counts_voxels;    // steps are in voxels: there is a grid
    double path_length;    // m, or voxels where these are counted: the longest way that is marched
    bool is_even;          // all media are homogeneous without falloff
    bool has_media, has_lights, has_extinction, has_paths, has_roughness;
    // Shares of rays, by how deep they go: optical depths, one a measured ray that meets anything.
    const float *depths; // borrowed
    size_t depth_count;
    double hit_share; // the share of rays that meet a medium
    double pixels;
};

struct plan_family {
    const char *name;
    enum job_method method;
    int order; // gauss
    bool (*serves)(const struct plan_scene *scene);
    enum plan_axis axes[PLAN_AXIS_LIMIT];
    int axis_count;
};

// Without the depths, which are to be measured. `job` outlives the scene.
void plan_scene_init(struct plan_scene *scene, const struct job *job);

extern const struct plan_family plan_families[];
extern const size_t plan_family_count;

// True when the method is there and takes this scene.
bool plan_family_serves(const struct plan_family *family, const struct plan_scene *scene);
// The axes that matter to this scene, `axes` having room for all.
int plan_family_axes(const struct plan_family *family, const struct plan_scene *scene,
                     enum plan_axis axes[static PLAN_AXIS_LIMIT]);
int plan_axis_last_rung(enum plan_axis axis, const struct plan_scene *scene);
// A point of the family as a job's quality: what the job says of samples and tolerance stays.
struct job_quality plan_family_quality(const struct plan_family *family, const struct plan_scene *scene,
                                       const struct plan_point *point);

// Evaluations of density of a pixel, counted from the numbers alone; looking something up counts as a part of one.
double plan_family_work(const struct plan_scene *scene, const struct job_quality *quality);
