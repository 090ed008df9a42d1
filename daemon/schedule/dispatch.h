// How many frames a worker gets at once: enough that handing them out costs nothing, few enough to share the end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { DISPATCH_CHUNK_LIMIT = 256 };

struct dispatch_load {
    double frame_s;    // median seconds of the job's frames; 0: unknown, and the worker gets one frame to find out
    double overhead_s; // what one assignment costs until its first frame starts; 0: one millisecond
    int64_t left;      // frames of the job that wait in the queue
    int workers;       // that may render the job, this one included; at least 1
    size_t in_flight;  // frames of the job this worker was given and has not rendered (nor skipped) yet; encoding ones
                       // do not count
    double other_jobs_s; // what frames of other jobs that it has not rendered will take; infinite: nobody knows
};

// How many frames to give the worker now; 0: none yet, ask again when it has rendered one. With long frames it holds
// the one it renders and gets the next on frame.rendered, while that one is encoded; with short ones it is topped up
// to a chunk when half of it is gone. No frame waits behind another job's that may take longer than such a half.
size_t dispatch_count(const struct dispatch_load *load);
