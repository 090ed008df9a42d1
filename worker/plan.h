// What a tolerance comes down to: the method and its numbers for a stretch of an animation.
#pragma once

#include "core/job.h"

enum { PLAN_REASON_SIZE = 320 };

struct plan {
    struct job_quality
        quality;        // of a method that renders, never auto; what the job itself says of samples and paths is in it
    double predicted_s; // a frame at the job's resolution, rendering alone, on this worker; 0: not known
    double predicted_error;        // relative RMSE
    char reason[PLAN_REASON_SIZE]; // one sentence: why this and no other
};
