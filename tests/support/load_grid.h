// A job's grids, read whole for the reference.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

struct job;
struct still_inputs;

// Reads the grids and temperatures of each medium at `frame`, other inputs being empty; fails the test when it cannot.
void load_grid_inputs(struct still_inputs *inputs, const struct job *job, int32_t frame);
void load_grid_finish(struct still_inputs *inputs);
