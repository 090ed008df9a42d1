// Sweeps of one number through where methods of light may fail, each point against reference/.
#pragma once

#include "core/job.h"

#include <stdbool.h>
#include <stddef.h>

enum { STABILITY_POINT_LIMIT = 12 };

// A row of the map: a scene, one number of which goes through `values`.
struct stability_sweep {
    const char *name; // what the number is
    const char *slug; // its short name
    double values[STABILITY_POINT_LIMIT];
    size_t count;
};

extern const struct stability_sweep stability_sweeps[];
extern const size_t stability_sweep_count;

// A column: a method and the numbers that it has throughout.
struct stability_method {
    const char *name;
    const char *quality; // members of the job's "quality"
    bool wants_even;     // it is for homogeneous media alone
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

// Fills `points`, one a value. False, with a message printed, when the scene itself cannot be measured.
bool stability_measure(struct gl_context *context, const struct stability_sweep *sweep,
                       const struct stability_method *method, struct stability_point *points);
