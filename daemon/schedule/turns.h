// Whose turn it is: jobs with frames to take, by priority and owner, and which of them a worker serves next. Pure.
// SPDX-License-Identifier: Apache-2.0
//
// Seats are of kinds, the pools of their workers, and a job may be barred from some.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    TURNS_PRIORITY_LIMIT = 201, // priorities are in [0, TURNS_PRIORITY_LIMIT); the highest is first
    TURNS_KIND_LIMIT = 64       // kinds of seats are in [0, TURNS_KIND_LIMIT)
};

// Members that are 0 take the default.
struct turns_rules {
    double half_life_s; // after so long half of what an owner used is forgotten; default 3600
    // The jobs of one owner and priority, of those that the same seats may serve, get a worker after so long at the
    // latest; default a day.
    int64_t longest_wait_ms;
};

// Whoever owns jobs: one per uid, until turns_finish.
struct turns_owner {
    int64_t uid;
    double weight;     // > 0; the owner's share among those who want workers; 1 unless set
    double used_s;     // of workers, with the half-life
    double unstored_s; // of that: what was used since the caller last stored it
    int workers;       // seats that serve the owner
    int64_t left_ms;   // when the last of them was left
    int64_t ready_ms;  // when the owner got jobs with frames to take, after having none
    int ready_lanes;   // of the owner's jobs with frames to take: how many differ in priority or barred kinds
    bool is_new;       // the owner had neither such jobs nor a worker before, and got no worker yet
};

struct turns_lane;

// A job as this module sees it, inside the caller's struct. The zero value is not ready.
struct turns_job {
    int64_t id;
    int priority;
    uint64_t barred;           // bits (1 << kind) of seats that may not serve it
    struct turns_owner *owner; // borrowed from the turns
    // For the module only.
    bool is_ready;
    bool is_covered; // enough workers are on their way to it
    struct turns_lane *lane;
    struct turns_job *next, *previous; // on the lane's list, by id
    struct turns_job *next_covered;    // on the turns' list of covered jobs
};

// Whom one worker serves. The zero value: nobody, by a worker of kind 0.
struct turns_seat {
    int kind; // set by the caller, and never changed
    struct turns_owner *owner;
    int64_t since_ms;            // when it began to serve the owner
    bool is_fresh;               // the owner got it before the stay of another was over: they keep it for theirs
    bool is_overdue;             // `promised` waited for too long
    struct turns_lane *promised; // the worker is changing for it
};

struct turns;

struct turns *turns_create(void);
void turns_destroy(struct turns *turns); // accepts NULL
void turns_set_rules(struct turns *turns, const struct turns_rules *rules);
// A worker stays with an owner for `stay_ms`, for a change costs time; 5 s unless set.
void turns_set_stay_ms(struct turns *turns, int64_t stay_ms);

// Finds or adds the owner.
struct turns_owner *turns_find_owner(struct turns *turns, int64_t uid);
struct turns_owner *turns_owner_at(const struct turns *turns, size_t index); // NULL: there are no more

// Tells the time of a monotonic clock, which all of these functions use: several times a second, and before a choice.
void turns_advance(struct turns *turns, int64_t now_ms);

// Whether the job has frames to take. Its id, priority, owner and barred kinds stay the same while it has.
void turns_set_ready(struct turns *turns, struct turns_job *job, bool is_ready);

bool turns_may_serve(const struct turns_seat *seat, const struct turns_job *job); // the seat's kind is not barred
// The owner's first of that priority and those barred kinds; the job is ready.
const struct turns_job *turns_first_of_lane(const struct turns_job *job);

// The jobs that are ready, lane by lane, the highest priority first; of a lane by id. NULL for `job`: the first; NULL:
// there are no more. `job` is ready.
struct turns_job *turns_next_ready(const struct turns *turns, const struct turns_job *job);

// The job that the seat serves next; NULL: none. With a seat of nobody, the job that is first for any of its kind.
// - Jobs of an owner and a priority that waited for the longest wait come first, once.
// - Then the highest priority counts, then the owner who used the least for their weight; of an owner's jobs the first.
// - A seat stays with its owner for the stay, while they have jobs of that priority; but an owner who is new and used
//   less is served at once. One who had no worker for 20 stays of each who wants one is served whatever they used.
struct turns_job *turns_choose(const struct turns *turns, const struct turns_seat *seat);
// Whether `job`, which was chosen for the seat, would be chosen even if `other` of the same or a lower priority had
// frames to take.
bool turns_outranks(const struct turns *turns, const struct turns_seat *seat, const struct turns_job *job,
                    const struct turns_job *other);
// Enough workers are on their way to the job: until turns_uncover it is not chosen.
void turns_cover(struct turns *turns, struct turns_job *job);
void turns_uncover(struct turns *turns); // all jobs

// The seat's worker takes frames of the job, or (`promise`) changes for it, which the next choice for the seat heeds
// unless a higher priority comes.
void turns_sit(struct turns *turns, struct turns_seat *seat, struct turns_job *job, bool promise);
void turns_stand(struct turns *turns, struct turns_seat *seat); // the seat serves nobody
// The seat's worker worked for `seconds`.
void turns_charge(struct turns_seat *seat, double seconds);
