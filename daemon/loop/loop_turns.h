// The turns of the loop: how much processor time each takes, and tasks that are done in short steps, some each turn.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/loop/turn_counts.h"

#include <stdbool.h>

#include <uv.h>

struct loop_turns;

// What is done step by step. It belongs to the caller, who sets `step`; the rest is for the module.
struct loop_task {
    // One step on the loop, of a millisecond at the most; true: there is more to do. The task may be freed by a step
    // that returns false.
    bool (*step)(struct loop_task *task);
    struct loop_task *next; // on the list of tasks that wait
    bool is_waiting;
};

struct loop_turns *loop_turns_open(uv_loop_t *loop);
// Does all steps that are left. The turns free themselves when the loop has closed their handles; accepts NULL.
void loop_turns_close(struct loop_turns *turns);

// Tasks take turns step by step, in the order in which they came. All steps of one turn of the loop take about 5 ms;
// what is left waits for the next turn, so that the loop hears sockets and timers between. Does nothing when the task
// waits.
void loop_turns_put(struct loop_turns *turns, struct loop_task *task);
void loop_turns_remove(struct loop_turns *turns, struct loop_task *task); // accepts a task that does not wait

// The processor time of the loop's thread, turn by turn, without the time that it waits.
const struct turn_counts *loop_turns_counts(const struct loop_turns *turns);
