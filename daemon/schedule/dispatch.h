// How many frames a worker is assigned at once: enough to hide the overhead, few enough that workers finish together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { DISPATCH_CHUNK_LIMIT = 256 };

struct dispatch_load {
    double frame_s;      // median seconds of the job's frames; 0: unknown, so that the worker gets one frame
    double overhead_s;   // seconds from an assignment to the start of its first frame; 0: one millisecond
    int64_t left;        // queued frames of the job
    int workers;         // that may render the job, this one included; at least 1
    size_t in_flight;    // frames of the job that were assigned to the worker and neither rendered nor skipped; frames
                         // being encoded do not count
    double other_jobs_s; // seconds that the worker's frames of other jobs will take; infinite: unknown
};

// How many frames to assign to the worker now; 0: none until it has rendered one. Long frames are assigned one at a
// time, on frame.rendered, so that one is encoded while the next is rendered. Short frames are assigned in chunks, when
// half of a chunk is rendered. No frame waits behind frames of another job that may take longer than half a chunk.
size_t dispatch_count(const struct dispatch_load *load);
