// The grids of a job's frame as reference/ wants them: read by the worker's readers, then plain numbers.
#pragma once

#include "reference/still.h"

#include <stdint.h>

struct job;

// Reads every grid of the frame; a failure fails the test. The caller frees the values with still_grids_finish.
void still_grids_read(struct still_inputs *inputs, const struct job *job, int32_t frame);
void still_grids_finish(struct still_inputs *inputs);
