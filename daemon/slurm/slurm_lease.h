// The lease of a pool's allocations: a counter in a file, which moves while the daemon lives.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include <uv.h>

struct slurm_lease;

// `folder` is made if it is not there, and must be the daemon's own. Both are copied.
struct slurm_lease *slurm_lease_create(uv_loop_t *loop, const char *folder, const char *name);
void slurm_lease_move(struct slurm_lease *lease);                 // in a thread; does nothing while one is at it
const char *slurm_lease_path(const struct slurm_lease *lease);    // of the file; borrowed
bool slurm_lease_is_held(const struct slurm_lease *lease);        // it was written
const char *slurm_lease_trouble(const struct slurm_lease *lease); // why it could not be written lately; NULL: it could
void slurm_lease_close(struct slurm_lease *lease);                // frees it, in a while; accepts NULL
