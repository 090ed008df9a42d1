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
// The node has no work, and the next frames would not be done before its machine goes: it is given back now.
void slurm_pool_note_short(struct slurm_pool *slurm, int node);
double slurm_pool_stay_s(const struct slurm_pool *slurm); // for how long its machines stayed at most; 0: unknown

struct slurm_need {
    int64_t tasks;     // frames that could be rendered at once, had there been workers: those in hand here, and others
    double too_long_s; // what a frame takes that waits, and that no machine stays for; 0: there is none
};

// To be called several times a second.
void slurm_pool_check(struct slurm_pool *slurm, const struct slurm_need *need, int64_t now_ms);
// The same while the daemon waits for its last frames: nothing is asked for and nothing is given back.
void slurm_pool_keep(struct slurm_pool *slurm, int64_t now_ms);
// Nothing is asked of Slurm any more. What it has lent stays for another daemon of the farm, for the time of the lease.
void slurm_pool_stop(struct slurm_pool *slurm);
void slurm_pool_destroy(struct slurm_pool *slurm); // legal when it is stopped; accepts NULL
