// Brings back what the store holds: jobs, their frames, and files whose publishing was cut short.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct farm;
struct store;

// Blocking; before the loop runs and before anything is committed.
bool restore_farm(struct farm *farm, struct store *store, struct error *error);
// Once the loop's modules exist: winds up the jobs that had ended but were not swept.
void restore_end_jobs(struct farm *farm);
