// One command of Slurm's at work, with a limit of its time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

#include <uv.h>

struct error;
struct node_launch_order;
struct slurm_call;

struct slurm_answer {
    char *text;          // what it printed, ended by NUL; NULL: it did not end, or printed too much
    bool is_whole;       // it ended with exit status 0: one that was killed may have printed some lines only
    const char *trouble; // what it said of a fault; "": nothing
};

// The callee closes the call.
typedef void slurm_call_on_end(void *user, const struct slurm_answer *answer);

// `order` is borrowed during the call. NULL on failure, with the cause.
struct slurm_call *slurm_call_start(uv_loop_t *loop, const struct node_launch_order *order, slurm_call_on_end *on_end,
                                    void *user, struct error *error);
void slurm_call_close(struct slurm_call *call); // ends it where it runs, unheard; it frees itself; accepts NULL
