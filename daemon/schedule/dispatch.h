// How many frames a worker is assigned at once: enough to hide the overhead, few enough that workers finish together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Frames in a worker's chunk, and in those of all workers that may render the job: their answers, which may all come at
// once, are read in one turn of the loop.
enum { DISPATCH_CHUNK_LIMIT = 256, DISPATCH_LIMIT = 10000 };

struct dispatch_load {
    double frame_s;      // median seconds of the job's frames; 0: unknown, so that the worker gets one frame
    size_t skip_run;     // frames of the job that were skipped since one was rendered
    double skip_s;       // mean seconds of a skipped frame
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
// After skipped frames the worker gets twice as many as were skipped, in chunks of their seconds: any may be rendered.
size_t dispatch_count(const struct dispatch_load *load);
// How many more frames a worker whose machine goes in `left_s` renders before, with `in_flight` in hand; SIZE_MAX:
// unknown, for a frame's time is (0), or the machine stays (infinite).
size_t dispatch_count_fitting(double frame_s, double left_s, size_t in_flight);
// Whether a worker that renders a frame has too many others of the job in hand: `count` that it has not begun.
bool dispatch_is_overfull(double frame_s, size_t count);
