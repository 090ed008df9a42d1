// Finds the frames of a job that a retry queues again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

struct frame_range;
struct queue_job;

// The ascending indices of the frames in one of `states` (bits 1 << enum frame_state), but for queued and running ones,
// and in `range` (NULL: all); owned by the caller, NULL when there are none. Takes time for the frames of `range` alone
// where they are fewer than the job's.
size_t queue_search_frames(const struct queue_job *job, unsigned states, const struct frame_range *range,
                           int32_t **indices);
