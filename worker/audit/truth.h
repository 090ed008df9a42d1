// The light that pixels of a frame should show: reference/ along the same rays and at the same moments as the renderer.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/integrate.h"
#include "reference/still.h"
#include "worker/picture/pixel.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct job;
struct truth;

// True when reference/ has a twin of every density and knows the light exactly: false for the user's GLSL, which only
// the shader can evaluate, for lights with size and for more than one order of scattering.
bool truth_has_twin(const struct job *job);

// True when it is measured by random paths, in two halves: light of more orders than one, and of lamps with a size.
bool truth_is_random(const struct job *job);

struct truth_params {
    const struct job *job; // borrowed; outlives the truth; its size and samples are those of the measured frames
    int32_t frame;
    bool is_for_plan; // random paths have numbers of their own, so that audits know nothing of what plans went by
    // Twins of densities in GLSL, by medium. Borrowed; they outlive the truth. NULL: none.
    const struct still_function *functions;
};

// Reads the frame's input files. The light is exact: rays are followed for 32 reflections and refractions, down to a
// throughput of 1e-6, whatever the job's max_depth and min_throughput cut. NULL on failure: a file, memory, or a
// density without a twin.
struct truth *truth_open(const struct truth_params *params, struct error *error);
// Changes to another frame of the same job. Files that have not changed are not read again. On failure nothing can be
// measured until a call succeeds.
bool truth_seek(struct truth *truth, int32_t frame, struct error *error);
void truth_close(struct truth *truth); // accepts NULL
// What it has read of the frame's files; borrowed until it seeks or closes.
const struct still_inputs *truth_inputs(const struct truth *truth);

struct truth_pixel {
    double rgb[3]; // mean of the samples
    // `variance` is that of each colour of a rendered picture about the light: rough surfaces have random normals, and
    // the reference's differ from the renderer's. `rgb` itself has `share` times this variance. 0 without rough
    // surfaces.
    double variance[3], share;
    // Half of the difference between two independent random measurements of the light, of which `rgb` is the mean; 0
    // where the light is exact.
    double half[3];
    bool is_converged; // false when refinement ended before it reached the accuracy
};

// `accuracy` may be NULL: reference/'s own. Any number of threads may measure at once.
struct truth_pixel truth_measure(const struct truth *truth, int x, int y, const struct integrate_accuracy *accuracy);

struct truth_many {
    const struct pixel *points; // `count`
    struct truth_pixel *pixels; // `count`; filled in order
    size_t count;
    const struct integrate_accuracy *accuracy; // may be NULL
    int thread_count;                          // 0: a thread for each core
    bool (*on_progress)(
        void *user); // may be NULL; called in the caller's thread after each of its samples; false: stop
    void *user;
    double *done; // NULL, or where the share of the samples that are taken is noted before on_progress is called
};

// Threads share the samples of all pixels. Returns the number of measured pixels: all, unless it was stopped.
size_t truth_measure_many(const struct truth *truth, const struct truth_many *many);
