// The time limits of a worker and of the frame that it renders.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct farm;
struct worker_process;

// Kills the worker if it is over a limit; warns of a frame that takes long. To be called several times a second.
void worker_clock_check(struct farm *farm, struct worker_process *worker, int64_t now_ms);
