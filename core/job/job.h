// A job: a scene, the frames to render of it, how well, and where to.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/frame_order.h"
#include "core/job/frame_range.h"
#include "core/job/job_after.h"
#include "core/job/job_notes.h"
#include "core/job/job_notify.h"
#include "core/job/output_path.h"
#include "core/scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

enum {
    JOB_VERSION = 1,      // of the job format
    JOB_NAME_LIMIT = 128, // bytes
    JOB_PRIORITY_DEFAULT = 50,
    JOB_PRIORITY_USER_MAX = 100, // higher ones are for administrators
    JOB_PRIORITY_MAX = 200,
    JOB_FRAME_LIMIT_MAX = 10 * 1000 * 1000, // s
    JOB_POOL_LIMIT = 64,                    // bytes of a pool's name or tag
    JOB_RESOLUTION_LIMIT = 16384,           // pixels a side
    JOB_PIXEL_LIMIT = 64 * 1024 * 1024,     // pixels in all
    // Software GL ends a loop after 65535 iterations, so the shaders' loops are bounded a little below.
    JOB_MARCH_STEPS_LIMIT = 60 * 1000, // along one camera or shadow ray
    // Along a camera ray that is continued in further passes (slices). Rounding then loses about a thousandth of the
    // light.
    JOB_SLICED_STEPS_LIMIT = 200 * 1000,
    JOB_POINT_LIMIT = 1000,  // equiangular points
    JOB_SAMPLE_LIMIT = 1024, // a pixel
    JOB_DEPTH_LIMIT = 32,
    JOB_ORDER_LIMIT = 4,
    JOB_GRID_LIMIT = 512,        // cells along a side of a frame's grid of light or density
    JOB_CACHED_MEDIUM_LIMIT = 4, // media of varying density with cached: the channels of a texel
    JOB_DEPTH_DEFAULT = 8,
    JOB_STRIDE_DEFAULT = 16, // of lattices of traced pixels
    JOB_STRIDE_LIMIT = 64,
    JOB_PATH_LIMIT = 1 << 20,    // a pixel, or a node
    JOB_PATH_DEFAULT = 256,      // a node
    JOB_SCATTER_GRID_LIMIT = 256 // cells along a side
};

enum job_method {
    JOB_METHOD_RIEMANN,     // Riemann sum with right endpoints
    JOB_METHOD_MIDPOINT,    // midpoint rule, exact exponential in each segment; skips empty space, ends at bounds
    JOB_METHOD_EQUIANGULAR, // homogeneous media, in closed form; points distributed for a point light's 1 / r^2
    JOB_METHOD_JITTERED,    // midpoint, but each sample lies at a random position in its segment
    JOB_METHOD_ADAPTIVE,    // midpoint with segments of limited optical depth
    JOB_METHOD_GAUSS,  // midpoint with Gauss-Legendre quadrature of `order` points in each segment, also towards lights
    JOB_METHOD_CACHED, // midpoint; transmittances to each light come from a grid that is filled once a frame
    JOB_METHOD_PREINTEGRATED, // midpoint; the transfer function's integral between two end values comes from a table
    JOB_METHOD_TRACKING, // random estimates without bias: delta or ratio tracking and others, see enum job_estimator
    JOB_METHOD_PATHS,    // random paths of all orders of scattering, without bias
    JOB_METHOD_AUTO,     // the planner replaces it by the cheapest method that keeps `tolerance`
    JOB_METHOD_DRAFT     // the worker replaces it by the one that a count of its work favours
};
enum { JOB_METHOD_COUNT = JOB_METHOD_AUTO + 1 }; // methods that a job names; draft has no keys of its own

// True of methods that end their steps at the bounds of media and skip empty space: all that march but riemann.
bool job_method_takes_steps(enum job_method method);

// How tracking estimates the transmittance towards a light and along a camera ray.
enum job_estimator {
    JOB_ESTIMATOR_DELTA, // free flights with a majorant; 0 after a real collision, else 1
    JOB_ESTIMATOR_RATIO, // the product of 1 - density / majorant over all collisions
    // A power series around a jittered march. Kettunen et al., ACM Transactions on Graphics 40(4), 2021.
    JOB_ESTIMATOR_DEBIASED,
    JOB_ESTIMATOR_JACKKNIFE // two jittered marches, one of twice the steps, extrapolated. Peters, 2025
};

// What becomes of a frame that no setting within reach brings below the tolerance.
enum job_on_miss {
    JOB_ON_MISS_FAIL,
    JOB_ON_MISS_PUBLISH // the best rendering is published, and marked as missed
};

// Which pixels of a frame are traced; the others are interpolated (worker/pixels/pixel_lattice.h).
struct job_pixels {
    int stride;       // px, of the first lattice: a power of two, [2, JOB_STRIDE_LIMIT]; 0: every pixel is traced
    double threshold; // (0, 1]: the doubt, relative to the picture's RMS, above which a pixel is traced
};

// Where what fills a grid of scattered light begins.
enum { JOB_SIMILAR_LIMIT = 1000 };

enum job_scatter_from {
    JOB_SCATTER_FROM_ANY,    // where it costs less (worker/model/scatter_grid.h)
    JOB_SCATTER_FROM_LIGHTS, // particles fly out from the lights
    JOB_SCATTER_FROM_NODES   // walks lead from the grid's nodes to the lights
};

struct job_quality {
    enum job_method method;
    bool is_draft;                         // a quick look, with whatever method: no tolerance, no limit of cut light
    double tolerance;                      // auto: the largest allowed relative RMSE of a frame; else 0
    enum job_on_miss on_miss;              // (auto)
    double step;                           // m, along camera rays; 0: see step_voxels
    double light_step;                     // m, along shadow rays (methods that march); 0: see light_step_voxels
    double step_voxels, light_step_voxels; // the same in shortest voxel edges of the scene's finest grid
    int points;                            // for each light and interval of a ray (equiangular)
    int light_steps;                       // per shadow ray (riemann)
    double depth_step; // largest optical depth of a segment, by its strongest colour (adaptive; cached: 0: no limit)
    int order;         // points in a segment (gauss), [2, JOB_ORDER_LIMIT]
    int light_grid;    // cells along each side of a light's grid (cached; paths: 0: none)
    int density_grid;  // cells along the longest side of the grid that a costly density is baked into (cached); 0: none
    // Cells along the longest side of the grid of scattered light (above order 1, beside a march), [4,
    // JOB_SCATTER_GRID_LIMIT]; 0: none.
    int scatter_grid;
    enum job_scatter_from scatter_from; // (scatter_grid)
    // Scatterings of a walk from a node behind which media are similar ones, of less and broader scattering
    // (shaders/scatter_grid/similar.glsl); 0: never. Only where all orders are modelled.
    int similar_after;
    int paths;                    // a pixel (paths), or a node of the scatter_grid; 0: neither
    enum job_estimator estimator; // (tracking)
    double min_transmittance;     // a ray ends below it; 0: never
    // Russian roulette: a ray whose transmittance is below `roulette_below` survives with the probability
    // `roulette_survive`, by which its light is then divided.
    double roulette_below, roulette_survive; // 0: no roulette
    int samples;                             // per pixel, >= 1: random points in the pixel and times within the shutter
    struct job_pixels pixels;
    // For scenes with objects. A path is cut, and counted, when it has been reflected or refracted `max_depth` times,
    // or when its throughput (its strongest colour) is below `min_throughput`.
    int max_depth;         // [1, JOB_DEPTH_LIMIT]
    double min_throughput; // [0, 1)
    // [0, 1]: a frame fails if cut rays may have carried a larger share of its light. 1 with auto unless the job states
    // another, because a frame's measured error has the light that they carried.
    double max_cut;
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
    JOB_EXISTING_VERIFY, // skip a frame whose file exists and is whole and this job's; render the others
    JOB_EXISTING_OVERWRITE,
    JOB_EXISTING_FAIL
};

struct job_output {
    struct output_path path;
    bool path_is_absolute; // in the job
    enum job_pixel pixel;
    enum job_compression compression;
    bool has_depth;         // aov "Z"
    bool has_transmittance; // aov "transmittance"
    enum job_existing existing;
};

// The zero value is empty.
struct job {
    char *name; // owned
    struct job_notes notes;
    struct job_notify notify;
    struct job_after after;
    struct frame_range frames;
    int64_t fps_numerator, fps_denominator; // in lowest terms, each up to 1e9
    double time_offset;                     // s
    int width_px, height_px;
    struct scene scene;
    struct job_quality quality;
    struct job_output output;
    int priority;
    struct frame_order order;
    double frame_limit;        // s that the farm lets an attempt at a frame take; 0: its default
    char *pool;                // owned; name or tag of the pools whose workers render it; NULL: of any
    char hash[HASH_TEXT_SIZE]; // of everything that the picture depends on; equal hashes mean equal pixels
};

void job_finish(struct job *job);                            // accepts an empty job
double job_frame_time(const struct job *job, int32_t frame); // s
// From the time of the earliest frame to the end of the shutter of the latest. The range must not be empty.
struct timeline_span job_time_span(const struct job *job);
int job_find_step_limit(const struct job *job); // the largest number of steps along a camera ray
// True when the job itself says how it is rendered: neither auto nor draft.
bool job_quality_states_method(const struct job_quality *quality);
// Whether max_depth and min_throughput count: random paths have no limits of their own.
bool job_limits_rays(const struct job *job, const struct job_quality *quality);
// True when each medium needs a majorant: an upper bound of its density.
bool job_quality_has_majorants(const struct job_quality *quality);
const char *job_method_name(enum job_method method);
// The names of all methods that a job may name, in the order of enum job_method, then NULL.
void job_method_list(const char *names[static JOB_METHOD_COUNT + 1]);
const char *job_estimator_name(enum job_estimator estimator);
const char *job_compression_name(enum job_compression compression);
