// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/turns.h"

#include "core/base/alloc.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

enum { STAY_DEFAULT_MS = 5000, WAIT_DEFAULT_MS = 24 * 3600 * 1000, STARVING_STAYS = 20 };
static const double HALF_LIFE_DEFAULT_S = 3600;
static const int64_t NEVER_MS = INT64_MIN / 2;

// The ready jobs of one owner and priority that are barred from the same kinds of seats.
struct turns_lane {
    int priority;
    uint64_t barred;
    struct turns_owner *owner;           // borrowed
    struct turns_job *first, *last;      // by id
    int64_t served_ms;                   // when a frame of it was taken, or when it became ready
    struct turns_lane *next, *previous;  // on the list of ready lanes of its priority
    struct turns_lane *later, *earlier;  // on the list of ready lanes by served_ms
    struct turns_lane *next_of_priority; // on the list of all lanes of its priority
};

struct turns {
    struct turns_rules rules;
    int64_t stay_ms;
    int64_t now_ms;
    struct turns_owner **owners; // owned; by ascending uid
    size_t owner_count, owner_capacity;
    struct turns_lane *lanes[TURNS_PRIORITY_LIMIT]; // owned lists
    struct turns_lane *ready[TURNS_PRIORITY_LIMIT];
    int top;                            // no lane of a higher priority is ready
    struct turns_lane *oldest, *newest; // ready lanes by served_ms
    int ready_owners;                   // with a ready lane
    struct turns_job *covered;
};

struct turns *turns_create(void)
{
    struct turns *turns = xcalloc(1, sizeof *turns);

    turns_set_rules(turns, &(struct turns_rules){0});
    turns->stay_ms = STAY_DEFAULT_MS;
    return turns;
}

void turns_destroy(struct turns *turns)
{
    if (!turns) return;
    for (int priority = 0; priority < TURNS_PRIORITY_LIMIT; priority++)
        for (struct turns_lane *lane = turns->lanes[priority], *next; lane; lane = next) {
            next = lane->next_of_priority;
            free(lane);
        }
    for (size_t i = 0; i < turns->owner_count; i++)
        free(turns->owners[i]);
    free(turns->owners);
    free(turns);
}

void turns_set_rules(struct turns *turns, const struct turns_rules *rules)
{
    turns->rules = *rules;
    if (!(rules->half_life_s > 0)) turns->rules.half_life_s = HALF_LIFE_DEFAULT_S;
    if (rules->longest_wait_ms <= 0) turns->rules.longest_wait_ms = WAIT_DEFAULT_MS;
}

void turns_set_stay_ms(struct turns *turns, int64_t stay_ms)
{
    turns->stay_ms = stay_ms;
}

struct turns_owner *turns_find_owner(struct turns *turns, int64_t uid)
{
    size_t at = turns->owner_count;

    while (at > 0 && turns->owners[at - 1]->uid > uid)
        at--;
    if (at > 0 && turns->owners[at - 1]->uid == uid) return turns->owners[at - 1];
    turns->owners = xgrow(turns->owners, &turns->owner_capacity, turns->owner_count + 1, sizeof(struct turns_owner *));
    for (size_t i = turns->owner_count++; i > at; i--)
        turns->owners[i] = turns->owners[i - 1];
    turns->owners[at] = xcalloc(1, sizeof **turns->owners);
    *turns->owners[at] = (struct turns_owner){.uid = uid, .weight = 1, .left_ms = NEVER_MS};
    return turns->owners[at];
}

struct turns_owner *turns_owner_at(const struct turns *turns, size_t index)
{
    return index < turns->owner_count ? turns->owners[index] : NULL;
}

void turns_advance(struct turns *turns, int64_t now_ms)
{
    double kept;

    if (now_ms <= turns->now_ms) return;
    kept = exp2(-(double)(now_ms - turns->now_ms) / 1000 / turns->rules.half_life_s);
    turns->now_ms = now_ms;
    for (size_t i = 0; i < turns->owner_count; i++)
        turns->owners[i]->used_s *= kept;
}

static bool is_lane_of(const struct turns_lane *lane, const struct turns_job *job)
{
    return lane->owner == job->owner && lane->priority == job->priority && lane->barred == job->barred;
}

static struct turns_lane *find_lane(struct turns *turns, const struct turns_job *job)
{
    struct turns_lane *lane = turns->lanes[job->priority];

    while (lane && !is_lane_of(lane, job))
        lane = lane->next_of_priority;
    if (lane) return lane;
    lane = xcalloc(1, sizeof *lane);
    *lane = (struct turns_lane){.priority = job->priority,
                                .barred = job->barred,
                                .owner = job->owner,
                                .next_of_priority = turns->lanes[job->priority]};
    turns->lanes[job->priority] = lane;
    return lane;
}

// At the end of the lanes by served_ms.
static void begin_wait(struct turns *turns, struct turns_lane *lane)
{
    lane->served_ms = turns->now_ms;
    lane->earlier = turns->newest;
    lane->later = NULL;
    *(turns->newest ? &turns->newest->later : &turns->oldest) = lane;
    turns->newest = lane;
}

static void end_wait(struct turns *turns, struct turns_lane *lane)
{
    *(lane->earlier ? &lane->earlier->later : &turns->oldest) = lane->later;
    *(lane->later ? &lane->later->earlier : &turns->newest) = lane->earlier;
}

static int64_t idle_ms(const struct turns *turns, const struct turns_owner *owner)
{
    return owner->workers > 0 ? 0 : turns->now_ms - owner->left_ms;
}

static void add_lane(struct turns *turns, struct turns_lane *lane)
{
    struct turns_owner *owner = lane->owner;

    if (owner->ready_lanes == 0) {
        owner->is_new = idle_ms(turns, owner) >= turns->stay_ms;
        owner->ready_ms = turns->now_ms;
    }
    turns->ready_owners += owner->ready_lanes++ == 0;
    lane->previous = NULL;
    lane->next = turns->ready[lane->priority];
    if (lane->next) lane->next->previous = lane;
    turns->ready[lane->priority] = lane;
    if (lane->priority > turns->top) turns->top = lane->priority;
    begin_wait(turns, lane);
}

static void remove_lane(struct turns *turns, struct turns_lane *lane)
{
    *(lane->previous ? &lane->previous->next : &turns->ready[lane->priority]) = lane->next;
    if (lane->next) lane->next->previous = lane->previous;
    while (turns->top > 0 && !turns->ready[turns->top])
        turns->top--;
    end_wait(turns, lane);
    turns->ready_owners -= --lane->owner->ready_lanes == 0;
}

// A new job is nearly always the last of its lane, and one whose frame comes back nearly always the first.
static void add_job(struct turns_lane *lane, struct turns_job *job)
{
    struct turns_job *previous = lane->first && job->id < lane->first->id ? NULL : lane->last;

    while (previous && previous->id > job->id)
        previous = previous->previous;
    job->previous = previous;
    job->next = previous ? previous->next : lane->first;
    *(previous ? &previous->next : &lane->first) = job;
    *(job->next ? &job->next->previous : &lane->last) = job;
}

static void remove_job(struct turns_lane *lane, struct turns_job *job)
{
    *(job->previous ? &job->previous->next : &lane->first) = job->next;
    *(job->next ? &job->next->previous : &lane->last) = job->previous;
}

static void uncover_job(struct turns *turns, struct turns_job *job)
{
    struct turns_job **link = &turns->covered;

    while (*link != job)
        link = &(*link)->next_covered;
    *link = job->next_covered;
    job->is_covered = false;
}

void turns_set_ready(struct turns *turns, struct turns_job *job, bool is_ready)
{
    if (job->is_ready == is_ready) return;
    job->is_ready = is_ready;
    if (is_ready) {
        assert(job->priority >= 0 && job->priority < TURNS_PRIORITY_LIMIT);
        if (!job->lane || !is_lane_of(job->lane, job)) job->lane = find_lane(turns, job);
        if (!job->lane->first) add_lane(turns, job->lane);
        add_job(job->lane, job);
        return;
    }
    if (job->is_covered) uncover_job(turns, job);
    remove_job(job->lane, job);
    if (!job->lane->first) remove_lane(turns, job->lane);
}

void turns_cover(struct turns *turns, struct turns_job *job)
{
    assert(job->is_ready);
    if (job->is_covered) return;
    job->is_covered = true;
    job->next_covered = turns->covered;
    turns->covered = job;
}

void turns_uncover(struct turns *turns)
{
    while (turns->covered)
        uncover_job(turns, turns->covered);
}

const struct turns_job *turns_first_of_lane(const struct turns_job *job)
{
    return job->lane->first;
}

struct turns_job *turns_next_ready(const struct turns *turns, const struct turns_job *job)
{
    if (job && job->next) return job->next;
    if (job && job->lane->next) return job->lane->next->first;
    for (int priority = job ? job->lane->priority - 1 : turns->top; priority >= 0; priority--)
        if (turns->ready[priority]) return turns->ready[priority]->first;
    return NULL;
}

bool turns_may_serve(const struct turns_seat *seat, const struct turns_job *job)
{
    return !(job->barred >> seat->kind & 1);
}

// The lane's job for the seat; NULL: none. As many jobs are covered as there are workers, at most.
static struct turns_job *find_job(const struct turns_lane *lane, const struct turns_seat *seat)
{
    struct turns_job *job = lane->barred >> seat->kind & 1 ? NULL : lane->first;

    while (job && job->is_covered)
        job = job->next;
    return job;
}

// What the owner used for their weight. A seat counts in advance, so that owners share workers rather than swap them.
static double find_use(const struct turns *turns, const struct turns_seat *seat, const struct turns_owner *owner)
{
    int others = owner->workers - (seat->owner == owner);

    return (owner->used_s + others * (double)turns->stay_ms / 1000) / owner->weight;
}

static bool is_starving(const struct turns *turns, const struct turns_owner *owner)
{
    int64_t since_ms = owner->ready_ms > owner->left_ms ? owner->ready_ms : owner->left_ms;

    return owner->workers == 0 && turns->now_ms - since_ms >= STARVING_STAYS * turns->ready_owners * turns->stay_ms;
}

static bool comes_before(const struct turns *turns, const struct turns_seat *seat, const struct turns_job *a,
                         const struct turns_job *b)
{
    bool a_starves = is_starving(turns, a->owner), b_starves = is_starving(turns, b->owner);
    double a_use = find_use(turns, seat, a->owner), b_use = find_use(turns, seat, b->owner);

    if (a_starves != b_starves) return a_starves;
    if (a_starves && a->owner->left_ms != b->owner->left_ms) return a->owner->left_ms < b->owner->left_ms;
    return a_use != b_use ? a_use < b_use : a->id < b->id;
}

// Whether the seat may leave its owner for another, who comes first: one who used less by half a stay, so that two who
// used the same do not swap.
static bool may_leave(const struct turns *turns, const struct turns_seat *seat, const struct turns_owner *owner)
{
    if (!seat->owner) return true;
    if (turns->now_ms - seat->since_ms < turns->stay_ms) return owner->is_new && !seat->is_fresh;
    return owner->is_new || is_starving(turns, owner) ||
           find_use(turns, seat, seat->owner) - find_use(turns, seat, owner) > (double)turns->stay_ms / 2000;
}

static struct turns_job *choose_at(const struct turns *turns, const struct turns_seat *seat, int priority)
{
    struct turns_job *best = NULL, *own = NULL;

    for (const struct turns_lane *lane = turns->ready[priority]; lane; lane = lane->next) {
        struct turns_job *job = find_job(lane, seat);

        if (!job) continue;
        if (lane == seat->promised) return job;
        if (lane->owner == seat->owner && (!own || job->id < own->id)) own = job;
        if (!best || comes_before(turns, seat, job, best)) best = job;
    }
    return own && !may_leave(turns, seat, best->owner) ? own : best;
}

struct turns_job *turns_choose(const struct turns *turns, const struct turns_seat *seat)
{
    struct turns_job *job = NULL;

    if (seat->is_overdue && seat->promised) job = find_job(seat->promised, seat);
    for (const struct turns_lane *lane = turns->oldest; lane && !job; lane = lane->later) {
        if (turns->now_ms - lane->served_ms < turns->rules.longest_wait_ms) break;
        job = find_job(lane, seat);
    }
    for (int priority = turns->top; priority >= 0 && !job; priority--)
        job = choose_at(turns, seat, priority);
    return job;
}

bool turns_outranks(const struct turns *turns, const struct turns_seat *seat, const struct turns_job *job,
                    const struct turns_job *other)
{
    if (job->priority != other->priority) return job->priority > other->priority;
    return job->owner != other->owner && may_leave(turns, seat, job->owner) && comes_before(turns, seat, job, other);
}

void turns_sit(struct turns *turns, struct turns_seat *seat, struct turns_job *job, bool promise)
{
    if (seat->owner != job->owner) {
        bool is_fresh = seat->owner && turns->now_ms - seat->since_ms < turns->stay_ms;

        turns_stand(turns, seat);
        job->owner->workers++;
        job->owner->is_new = false;
        *seat = (struct turns_seat){
            .kind = seat->kind, .owner = job->owner, .since_ms = turns->now_ms, .is_fresh = is_fresh};
    }
    if (job->lane && job->lane->first) {
        bool was_overdue = seat->is_overdue && seat->promised == job->lane;

        seat->is_overdue =
            promise && (was_overdue || turns->now_ms - job->lane->served_ms >= turns->rules.longest_wait_ms);
        end_wait(turns, job->lane);
        begin_wait(turns, job->lane);
    }
    if (seat->promised && !promise) seat->since_ms = turns->now_ms; // the change was no part of the stay
    seat->promised = promise ? job->lane : NULL;
}

void turns_stand(struct turns *turns, struct turns_seat *seat)
{
    if (seat->owner && --seat->owner->workers == 0) seat->owner->left_ms = turns->now_ms;
    *seat = (struct turns_seat){.kind = seat->kind};
}

void turns_charge(struct turns_seat *seat, double seconds)
{
    if (!seat->owner) return;
    seat->owner->used_s += seconds;
    seat->owner->unstored_s += seconds;
}
