// Sweeps jobs once more when the workers of a lost node can no longer write: a node that is not heard may go on.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct farm;
struct late_sweep;

// A frame of the job was on a node that is lost, and ends within `heartbeat_ms` by itself.
void late_sweep_note(struct farm *farm, int64_t job, int64_t heartbeat_ms);
// Sweeps the jobs that are due and over; one that runs is swept at its end. To be called several times a second.
void late_sweep_run(struct farm *farm);
void late_sweep_finish(struct farm *farm); // forgets all
