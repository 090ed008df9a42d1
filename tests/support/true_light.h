// A job's first frame against the converged integral.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/reference.h"
#include "worker/gl/gl_context.h"

#include <stddef.h>

struct job;

// Means over pixels and samples.
struct true_rays {
    double count, cut_count, cut_throughput, cut_by_depth;
};

struct true_light {
    struct reference_error radiance, transmittance, alpha, depth; // depth 0 where there is none
    struct true_rays rays_seen, rays_true;                        // of scenes that reflect or refract, else 0
};

// The true values of pixels, kept for further pictures. The zero value is empty.
struct true_light_truth {
    double *planes; // owned; NULL until measured
    size_t pixel_count;
    struct true_rays rays;
};

// Renders frame 0 on `backend` and measures every pixel anew with reference/; prints what came out. A failure fails the
// test, a backend that is not there skips it.
struct true_light true_light_compare(const struct job *job, enum gl_backend backend);
// The same without the `stray_count` pixels that differ most: a float and a double may see a ray on different sides of
// an edge. They are counted among the rays.
struct true_light true_light_compare_but(const struct job *job, enum gl_backend backend, size_t stray_count);
// The same with a truth that is measured when `truth` is empty and else taken from there: for jobs that differ only in
// the numbers of their method.
struct true_light true_light_compare_with(const struct job *job, enum gl_backend backend,
                                          struct true_light_truth *truth);
void true_light_truth_finish(struct true_light_truth *truth); // accepts an empty one
// True when none of radiance, transmittance and alpha differs by more, as a relative RMSE.
bool true_light_is_within(const struct true_light *light, double tolerance);
