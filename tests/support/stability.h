// Sweeps of one number through ranges in which methods may fail; each point is compared with reference/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

#include <stdbool.h>
#include <stddef.h>

enum { STABILITY_POINT_LIMIT = 12 };

// A row of the map: a scene in which one number takes `values`.
struct stability_sweep {
    const char *name; // of the number
    const char *slug; // its short name
    double values[STABILITY_POINT_LIMIT];
    size_t count;
    size_t quick_count; // the first of them, used by tests; 0: all
    bool is_apart;      // each value is a job of its own, else a frame of one job
    bool is_grid;       // it reads voxels
    bool is_change;     // the error is that of the picture's difference to value 0
    bool is_sparse;     // a larger picture, compared with its own frame of every pixel (stability_sparse.h)
};

extern const struct stability_sweep stability_sweeps[];
extern const size_t stability_sweep_count;

// A column: a method with fixed numbers.
struct stability_method {
    const char *name;
    const char *quality;      // members of the job's "quality"
    bool wants_even;          // only for homogeneous media
    const char *only;         // the slug of its only sweep; NULL: all
    double tolerance;         // planned and audited with this tolerance; 0: rendered with `quality`
    struct job_pixels pixels; // only for sweeps that are sparse, by the scene's own settings
};

extern const struct stability_method stability_methods[];
extern const size_t stability_method_count;

struct stability_point {
    bool is_refused; // by the job's parser, or the renderer
    char reason[256];
    bool is_finite;
    bool fits_half; // finite, and every value a half holds
    double gain;    // total light in the picture over the true one, less 1
    double error;   // relative RMSE, absolute where all light is below 1e-6
};

struct gl_context;

// The number of values that tests use.
struct stability_sweep stability_quick(const struct stability_sweep *sweep);
// False when the method does not apply to the sweep.
bool stability_concerns(const struct stability_sweep *sweep, const struct stability_method *method);
// Fills `points`, one for each value, for a method that applies. False, with a message printed, when the scene itself
// cannot be measured.
bool stability_measure(struct gl_context *context, const struct stability_sweep *sweep,
                       const struct stability_method *method, struct stability_point *points);
