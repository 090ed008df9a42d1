// A job: a scene, the frames to render of it, how well, and where to.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/frame_range.h"
#include "core/job/output_path.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    JOB_VERSION = 1,      // of the document
    JOB_NAME_LIMIT = 128, // bytes
    JOB_PRIORITY_DEFAULT = 50,
    JOB_PRIORITY_MAX = 100,
    JOB_RESOLUTION_LIMIT = 16384,       // pixels a side
    JOB_PIXEL_LIMIT = 64 * 1024 * 1024, // pixels in all
    // Software GL ends a loop after 65535 turns, so the shaders' loops are bounded a little below.
    JOB_MARCH_STEPS_LIMIT = 60 * 1000, // along one camera or shadow ray
    // Along a camera ray that goes on in another slice of the frame; a thousandth of the light is then lost to rounding.
    JOB_SLICED_STEPS_LIMIT = 200 * 1000,
    JOB_POINT_LIMIT = 1000,  // equiangular points
    JOB_SAMPLE_LIMIT = 1024, // a pixel
    JOB_DEPTH_LIMIT = 32,
    JOB_ORDER_LIMIT = 4,
    JOB_GRID_LIMIT = 512,        // cells along a side of what a frame keeps in a grid
    JOB_CACHED_MEDIUM_LIMIT = 4, // whose density varies: channels of a texel
    JOB_DEPTH_DEFAULT = 8
};

enum job_method {
    JOB_METHOD_RIEMANN,     // right ends, plain sums: the seeds' own
    JOB_METHOD_MIDPOINT,    // exact exponential a segment, empty space skipped, ends exactly
    JOB_METHOD_EQUIANGULAR, // homogeneous media: closed-form transmittance, points placed for a point light's 1 / r^2
    JOB_METHOD_JITTERED,    // midpoint, but for where in its segment each sample lies: anywhere, by lot
    JOB_METHOD_ADAPTIVE,    // midpoint, but for segments that are short where much is extinguished: by optical depth
    JOB_METHOD_GAUSS,       // midpoint with `order` points by Gauss and Legendre's rule a segment, towards lights too
    JOB_METHOD_CACHED, // midpoint whose light comes from a grid of transmittances for each light, made once a frame
    JOB_METHOD_PREINTEGRATED, // midpoint, but what a transfer function makes of a segment's two ends comes from a table
    JOB_METHOD_TRACKING,      // unbiased estimates by lot
    JOB_METHOD_AUTO           // whatever keeps `tolerance` at the least cost: a plan puts another in its place
};

// True when steps are shortened where media end, and jumped where they are empty: all that march but riemann.
bool job_method_takes_steps(enum job_method method);

// How tracking finds the transmittance towards a light and along a camera ray.
enum job_estimator {
    JOB_ESTIMATOR_DELTA, // collisions with a majorant: all or nothing
    JOB_ESTIMATOR_RATIO, // the product of what each collision leaves
    JOB_ESTIMATOR_DEBIASED, // a power series about a jittered march. Kettunen et al., ACM Transactions on Graphics 40(4), 2021
    JOB_ESTIMATOR_JACKKNIFE // two jittered marches, one of twice the steps, extrapolated. Peters, 2025
};

struct job_quality {
    enum job_method method;
    double tolerance;                      // auto: the largest relative RMSE of a frame; else 0
    double step;                           // m, along camera rays; 0: step_voxels says it
    double light_step;                     // m, along shadow rays (midpoint, jittered); 0: light_step_voxels says it
    double step_voxels, light_step_voxels; // in shortest voxel edges of the scene's finest grid
    int points;                            // per light and stretch of a ray (equiangular)
    int light_steps;                       // per shadow ray (riemann)
    double depth_step; // the most optical depth of a segment, by its strongest colour (adaptive; cached: 0 none)
    int order;         // points a segment (gauss), [2, JOB_ORDER_LIMIT]
    int light_grid;    // cells along each side of a light's grid (cached)
    int density_grid;  // cells along the longest side of the grid that a costly density is put in first
                       // (cached); 0: none is
    enum job_estimator estimator; // (tracking)
    double min_transmittance;     // a ray stops below it; 0 never stops
    // Below `roulette_below` a ray goes on with probability `roulette_survive`, its light divided by that (midpoint, jittered).
    double roulette_below, roulette_survive; // 0: no roulette
    int samples;                             // per pixel, >= 1: points in the pixel and moments of the shutter
    // Of scenes with objects. A ray that would be the next is cut, and counted, when it has been reflected or refracted
    // `max_depth` times before or its throughput (of its strongest colour) is below `min_throughput`.
    int max_depth;         // [1, JOB_DEPTH_LIMIT]
    double min_throughput; // [0, 1)
    double max_cut;        // [0, 1]: a frame fails of whose light cut rays may have taken a larger share
};

enum job_pixel { JOB_PIXEL_HALF, JOB_PIXEL_FLOAT };

enum job_compression {
    JOB_COMPRESSION_NONE,
    JOB_COMPRESSION_RLE,
    JOB_COMPRESSION_ZIPS,
    JOB_COMPRESSION_ZIP,
    JOB_COMPRESSION_PIZ
};

enum job_existing {
    JOB_EXISTING_VERIFY, // skip a frame whose file is there and proves to be this job's; render the rest
    JOB_EXISTING_OVERWRITE,
    JOB_EXISTING_FAIL
};

struct job_output {
    struct output_path path;
    bool path_is_absolute; // as the job has it
    enum job_pixel pixel;
    enum job_compression compression;
    bool has_depth;         // aov "Z"
    bool has_transmittance; // aov "transmittance"
    enum job_existing existing;
};

// The zero value is empty.
struct job {
    char *name; // owned
    struct frame_range frames;
    int64_t fps_numerator, fps_denominator; // in lowest terms, each up to 1e9
    double time_offset;                     // s
    int width_px, height_px;
    struct scene scene;
    struct job_quality quality;
    struct job_output output;
    int priority;
    char hash[HASH_TEXT_SIZE]; // of all that the picture depends on; equal hashes, equal pixels
};

void job_finish(struct job *job);                            // accepts an empty job
double job_frame_time(const struct job *job, int32_t frame); // s
// From the time of the earliest frame to when the shutter closes on the latest; the range is not empty.
struct timeline_span job_time_span(const struct job *job);
int job_find_step_limit(const struct job *job); // the most steps along a camera ray
// True when each medium needs a majorant: a number that its density is nowhere above.
bool job_quality_has_majorants(const struct job_quality *quality);
const char *job_method_name(enum job_method method);
const char *job_estimator_name(enum job_estimator estimator);
const char *job_compression_name(enum job_compression compression);
