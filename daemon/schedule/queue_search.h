// Finds the frames of a job that a retry queues again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/frame_set.h"

#include <stdint.h>

struct queue_job;

// Sets `indices` to the frames in one of `states` (bits 1 << enum frame_state), but for queued and running ones, and of
// which `numbers` (NULL: all) has the number. Returns how many they are.
int64_t queue_search_frames(const struct queue_job *job, unsigned states, const struct frame_set *numbers,
                            struct frame_set *indices);
