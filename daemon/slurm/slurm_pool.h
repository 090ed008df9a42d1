// A pool whose machines Slurm lends: asks for as many as the queue needs, starts nodes on them, and gives them back.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include <uv.h>

struct node;
struct pool_options;
struct slurm_pool;

struct slurm_pool_params {
    const struct pool_options *pool; // borrowed; outlives us
    struct node **nodes;             // borrowed; outlive us; as many as the pool has, held by slurm_pool_create
    const char *farm;                // borrowed; outlives us; its id, which is known at the first check
    const char *launch_socket;       // borrowed; outlives us; as of struct node_params
    const char *output_root;         // borrowed; outlives us; where the lease is unless the pool says where
};

struct slurm_pool *slurm_pool_create(uv_loop_t *loop, const struct slurm_pool_params *params);
// The node's workers have frames in hand.
void slurm_pool_note_busy(struct slurm_pool *slurm, int node, int64_t now_ms);
// To be called several times a second. `tasks` is how many frames could be rendered at once, had there been workers:
// those in hand here, and those that wait.
void slurm_pool_check(struct slurm_pool *slurm, int64_t tasks, int64_t now_ms);
// The same while the daemon waits for its last frames: nothing is asked for and nothing is given back.
void slurm_pool_keep(struct slurm_pool *slurm, int64_t now_ms);
// Nothing is asked of Slurm any more. What it has lent stays for another daemon of the farm, for the time of the lease.
void slurm_pool_stop(struct slurm_pool *slurm);
void slurm_pool_destroy(struct slurm_pool *slurm); // legal when it is stopped; accepts NULL
