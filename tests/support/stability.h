// Sweeps of one number through where methods of light may fail, each point against reference/.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/job.h"

#include <stdbool.h>
#include <stddef.h>

enum { STABILITY_POINT_LIMIT = 12 };

// A row of the map: a scene, one number of which goes through `values`.
struct stability_sweep {
    const char *name; // what the number is
    const char *slug; // its short name
    double values[STABILITY_POINT_LIMIT];
    size_t count;
    size_t quick_count; // the first of them, which tests make do with; 0: all
    bool is_apart;      // a value is a job of its own; otherwise a frame of one
    bool is_grid;       // it reads voxels
    bool is_change;     // the error is that of the picture's change since the value was 0
};

extern const struct stability_sweep stability_sweeps[];
extern const size_t stability_sweep_count;

// A column: a method and the numbers that it has throughout.
struct stability_method {
    const char *name;
    const char *quality; // members of the job's "quality"
    bool wants_even;     // it is for homogeneous media alone
    const char *only;    // the slug of the one sweep that it is for; NULL: all
    double tolerance;    // it is the farm's, planned and audited; 0: it is rendered as `quality` says
};

extern const struct stability_method stability_methods[];
extern const size_t stability_method_count;

struct stability_point {
    bool is_refused; // by the job's parser, or the renderer
    char reason[256];
    bool is_finite;
    bool fits_half; // finite, and every value a half holds
    double gain;    // of all light together: seen over true, less 1
    double error;   // relative RMSE, absolute where all light is below 1e-6
};

struct gl_context;

// What tests make do with of a sweep.
struct stability_sweep stability_quick(const struct stability_sweep *sweep);
// False: the method has nothing to do with it.
bool stability_concerns(const struct stability_sweep *sweep, const struct stability_method *method);
// Fills `points`, one a value, for a method that the sweep concerns. False, with a message printed, when the scene itself cannot be measured.
bool stability_measure(struct gl_context *context, const struct stability_sweep *sweep,
                       const struct stability_method *method, struct stability_point *points);
