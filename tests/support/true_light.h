// A job's first frame against the converged integral.
#pragma once

#include "reference/reference.h"
#include "worker/gl_context.h"

struct job;

struct true_light {
    struct reference_error radiance, transmittance, alpha;
};

// Renders frame 0 on `backend` and measures every pixel anew with reference/; prints what came out. A failure fails the
// test, a backend that is not there skips it.
struct true_light true_light_compare(const struct job *job, enum gl_backend backend);
// True when none of the three differs by more, as a relative RMSE.
bool true_light_is_within(const struct true_light *light, double tolerance);
