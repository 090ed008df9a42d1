// The machines that one pool has of Slurm: what was asked for, what Slurm said last, what is due. Pure.
// SPDX-License-Identifier: Apache-2.0
//
// Slurm may lose a job that it took, give a job's id out again, or take one without an answer. So each allocation has a
// name of its own, which is its job's name, and nothing is done by an id alone.
#pragma once

#include "daemon/slurm/slurm_text.h"

#include <stdbool.h>
#include <stdint.h>

struct error;

enum allocation_state {
    ALLOCATION_NONE,
    ALLOCATION_ASKED, // for; it may be there already
    ALLOCATION_WAITS, // in Slurm's queue
    ALLOCATION_RUNS
};

// Strings are owned.
struct allocation {
    enum allocation_state state;
    int64_t job;          // its id; 0: unknown
    char *machine;        // NULL: none yet
    char *reason;         // what Slurm said, for people; NULL: nothing
    int64_t end_ms;       // monotonic; when its time is over; 0: never, or unknown
    int64_t whole_ms;     // its time when it was seen first; 0: unknown
    bool is_short;        // what is left of it is too short for the next frames
    int64_t busy_ms;      // when it last had work, or began
    int64_t sure_from_ms; // of ASKED: an answer to a question from then on that lacks it says that it is not there
    int64_t over_job;     // the id that it had last
    int64_t cancel_ms;    // when it was last canceled; 0: it was not
    // Within an answer.
    int64_t seen_job; // 0: none
    bool is_kept;     // its present job was among them
};

struct allocations {
    char *token;            // owned; names are "TOKEN.NUMBER"
    struct allocation *all; // owned
    int count;
    bool is_known;       // Slurm has answered once
    int64_t surplus_job; // a second job of a name, which is to be canceled; 0: none
    int surplus_index;   // of that name
};

void allocations_init(struct allocations *allocations, const char *token, int count);
void allocations_finish(struct allocations *allocations);

// An answer of squeue about all of the names, to a question of `asked_ms`. A fault changes nothing.
bool allocations_take_answer(struct allocations *allocations, char *text, int64_t asked_ms, struct error *error);

int allocations_count(const struct allocations *allocations, enum allocation_state state);
// How many machines `tasks` need, of so many workers each.
int allocations_want(int64_t tasks, int workers, int min, int max);
// One to ask for, when less than `want` are there or asked for and nothing is in doubt; -1: none.
int allocations_find_to_ask(const struct allocations *allocations, int want);
// One to cancel: one that is too short, or, when more than `want` are there, first those that wait, then one without
// work for `idle_ms`; -1: none.
int allocations_find_to_cancel(const struct allocations *allocations, int want, int64_t idle_ms, int64_t now_ms);

void allocations_note_asked(struct allocations *allocations, int index);
// Slurm took it.
void allocations_note_job(struct allocations *allocations, int index, int64_t job, int64_t now_ms);
// Slurm did not say that it took it: that is sure a while later.
void allocations_note_silence(struct allocations *allocations, int index, const char *trouble, int64_t now_ms);
// `reason` may be NULL.
void allocations_note_canceled(struct allocations *allocations, int index, const char *reason, int64_t now_ms);
