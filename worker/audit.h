// How far a frame is from the light it should show: measured on some of its pixels against reference/.
#pragma once

#include <stdbool.h>

enum audit_kind {
    AUDIT_NONE,        // the job states no tolerance
    AUDIT_REFERENCE,   // against the converged integral, in double precision
    AUDIT_STEP_HALVING // against the same shader in finer steps: code of the user's has no twin
};

struct audit_result {
    enum audit_kind kind;
    bool is_pooled;   // over frames of the segment, not this one alone
    double error;     // relative RMSE of the values as encoded; absolute where all light is below 1e-6
    double error95;   // that is below this, with a confidence of 95 %
    int ray_count;    // pixels that were measured
    double tolerance; // what the job allows
    double seconds;   // that it took
};
