// Restores jobs and frames from the store, and finishes files whose publishing was interrupted.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct farm;
struct store;

// Blocking. To be called before the loop runs and before anything is committed.
bool restore_farm(struct farm *farm, struct store *store, struct error *error);
// Sweeps the jobs that had ended but were not swept. To be called when the modules of the loop exist.
void restore_end_jobs(struct farm *farm);
