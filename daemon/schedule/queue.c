// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/queue.h"

#include "core/base/alloc.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

enum { SEARCH_LIMIT = 100 * 1000 }; // positions of the order that one call of queue_take looks at in vain

struct queue_slot {
    int64_t id;
    struct queue_job *job; // owned
};

struct queue {
    int max_attempts;
    int64_t counts[FRAME_STATE_COUNT];
    struct queue_job *first;
    struct turns *turns;                          // owned
    struct queue_job *last[QUEUE_PRIORITY_LIMIT]; // per priority: the job with the highest id
    struct queue_slot *slots;                     // owned; by ascending id
    size_t slot_count, slot_capacity;
};

struct queue *queue_create(int max_attempts)
{
    struct queue *queue = xcalloc(1, sizeof *queue);

    assert(max_attempts >= 1 && max_attempts <= UINT16_MAX);
    queue->max_attempts = max_attempts;
    queue->turns = turns_create();
    return queue;
}

void queue_set_max_attempts(struct queue *queue, int max_attempts)
{
    assert(max_attempts >= 1 && max_attempts <= UINT16_MAX);
    queue->max_attempts = max_attempts;
}

static void destroy_job(struct queue_job *job)
{
    frame_range_finish(&job->frames);
    index_heap_finish(&job->returned);
    frame_states_finish(&job->states);
    free(job);
}

void queue_destroy(struct queue *queue)
{
    if (!queue) return;
    for (size_t i = 0; i < queue->slot_count; i++)
        destroy_job(queue->slots[i].job);
    free(queue->slots);
    turns_destroy(queue->turns);
    free(queue);
}

struct turns *queue_turns(struct queue *queue)
{
    return queue->turns;
}

// The index of the id, or where to insert it.
static size_t find_slot(const struct queue *queue, int64_t id)
{
    size_t low = 0;
    size_t high = queue->slot_count;

    if (high > 0 && queue->slots[high - 1].id < id) return high;
    while (low < high) {
        size_t middle = low + (high - low) / 2;

        if (queue->slots[middle].id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

struct queue_job *queue_find_job(const struct queue *queue, int64_t id)
{
    size_t slot = find_slot(queue, id);

    return slot < queue->slot_count && queue->slots[slot].id == id ? queue->slots[slot].job : NULL;
}

struct queue_job *queue_first_job(const struct queue *queue)
{
    return queue->first;
}

static bool is_ready(const struct queue_job *job)
{
    return job->states.counts[FRAME_QUEUED] > 0 && !job->is_paused && job->block == QUEUE_OPEN &&
           job->wait == QUEUE_WAITS_NOT && !job->is_canceled && !job->is_failed;
}

static bool comes_before(const struct queue_job *a, const struct queue_job *b)
{
    return a->priority != b->priority ? a->priority > b->priority : a->id < b->id;
}

// To be called after any change that may make the job ready, or no longer.
static void note_ready(struct queue_job *job)
{
    turns_set_ready(job->queue->turns, &job->turn, is_ready(job));
}

static struct queue_job *find_predecessor(const struct queue *queue, const struct queue_job *job)
{
    struct queue_job *previous = NULL;

    for (int priority = job->priority; priority < QUEUE_PRIORITY_LIMIT && !previous; priority++)
        previous = queue->last[priority];
    while (previous && comes_before(job, previous))
        previous = previous->previous;
    return previous;
}

static void link_job(struct queue *queue, struct queue_job *job)
{
    struct queue_job *previous = find_predecessor(queue, job);

    job->previous = previous;
    job->next = previous ? previous->next : queue->first;
    *(previous ? &previous->next : &queue->first) = job;
    if (job->next) job->next->previous = job;
    if (!job->next || job->next->priority != job->priority) queue->last[job->priority] = job;
}

static void unlink_job(struct queue *queue, struct queue_job *job)
{
    struct queue_job *previous = job->previous;

    if (queue->last[job->priority] == job)
        queue->last[job->priority] = previous && previous->priority == job->priority ? previous : NULL;
    *(previous ? &previous->next : &queue->first) = job->next;
    if (job->next) job->next->previous = previous;
    job->next = job->previous = NULL;
}

struct queue_job *queue_add_job(struct queue *queue, const struct queue_job_params *params)
{
    struct queue_job *job = xcalloc(1, sizeof *job);
    size_t slot = find_slot(queue, params->id);

    assert(params->priority >= 0 && params->priority < QUEUE_PRIORITY_LIMIT);
    assert(slot == queue->slot_count || queue->slots[slot].id != params->id);
    *job = (struct queue_job){.id = params->id,
                              .turn = {.id = params->id,
                                       .priority = params->priority,
                                       .barred = params->barred,
                                       .owner = turns_find_owner(queue->turns, params->owner_uid)},
                              .frames = *params->frames,
                              .priority = params->priority,
                              .is_paused = params->is_paused,
                              .wait = params->waits ? QUEUE_WAITS : QUEUE_WAITS_NOT,
                              .queue = queue};
    *params->frames = (struct frame_range){0};
    if (params->order) job->order = *params->order;
    frame_states_init(&job->states, frame_range_count(&job->frames), queue->counts);

    queue->slots = xgrow(queue->slots, &queue->slot_capacity, queue->slot_count + 1, sizeof queue->slots[0]);
    memmove(&queue->slots[slot + 1], &queue->slots[slot], (queue->slot_count - slot) * sizeof queue->slots[0]);
    queue->slots[slot] = (struct queue_slot){.id = params->id, .job = job};
    queue->slot_count++;
    link_job(queue, job);
    note_ready(job);
    return job;
}

void queue_remove_job(struct queue *queue, struct queue_job *job)
{
    size_t slot = find_slot(queue, job->id);

    turns_set_ready(queue->turns, &job->turn, false);
    unlink_job(queue, job);
    queue->slot_count--;
    memmove(&queue->slots[slot], &queue->slots[slot + 1], (queue->slot_count - slot) * sizeof queue->slots[0]);
    destroy_job(job);
}

void queue_note_missed(struct queue_job *job, int64_t index)
{
    frame_states_set_missed(&job->states, index);
}

void queue_restore_frame(struct queue_job *job, int64_t index, enum frame_state state, int attempts)
{
    assert(index >= 0 && index < job->states.frame_count && state != FRAME_RUNNING);
    frame_states_set(&job->states, index, state);
    if (attempts != 0) frame_states_set_attempt(&job->states, index, attempts);
    if (state != FRAME_QUEUED) job->has_started = true;
    note_ready(job);
}

enum job_state queue_job_state(const struct queue_job *job)
{
    if (job->is_failed) return JOB_FAILED;
    if (job->is_canceled) return JOB_CANCELED;
    if (job->states.counts[FRAME_QUEUED] == 0 && job->states.counts[FRAME_RUNNING] == 0) {
        if (job->states.counts[FRAME_FAILED] > 0) return JOB_FAILED;
        return job->states.counts[FRAME_CANCELED] > 0 ? JOB_CANCELED : JOB_SUCCEEDED;
    }
    if (job->is_paused || job->block == QUEUE_AWAY || job->wait == QUEUE_WAITS_IN_VAIN) return JOB_PAUSED;
    return job->has_started ? JOB_RUNNING : JOB_QUEUED;
}

bool queue_job_is_live(const struct queue_job *job)
{
    enum job_state state = queue_job_state(job);

    return state == JOB_QUEUED || state == JOB_RUNNING || state == JOB_PAUSED;
}

static struct queue_job *job_of(struct turns_job *turn)
{
    return turn ? (struct queue_job *)((char *)turn - offsetof(struct queue_job, turn)) : NULL;
}

struct queue_job *queue_next_ready(const struct queue *queue, const struct queue_job *job)
{
    return job_of(turns_next_ready(queue->turns, job ? &job->turn : NULL));
}

struct queue_job *queue_choose_job(const struct queue *queue, const struct turns_seat *seat)
{
    return job_of(turns_choose(queue->turns, seat ? seat : &(struct turns_seat){0}));
}

// False when the search is to go on at another time. The job must have a queued frame.
static bool take_index(struct queue_job *job, int32_t *index, int *looks)
{
    while (index_heap_take(&job->returned, index))
        if (frame_states_get(&job->states, *index) == FRAME_QUEUED) return true;
    for (; *looks > 0; (*looks)--) {
        *index = (int32_t)frame_order_at(&job->order, job->states.frame_count, job->next_position++);
        if (*index >= 0 && frame_states_get(&job->states, *index) == FRAME_QUEUED) return true;
    }
    return false;
}

static struct queue_ticket begin_attempt(struct queue_job *job, int32_t index, uint16_t worker)
{
    int32_t attempt = frame_states_begin_attempt(&job->states, index, worker);

    return (struct queue_ticket){.job = job->id,
                                 .frame = frame_range_at(&job->frames, index),
                                 .index = index,
                                 .attempt = attempt,
                                 .is_forced = frame_states_is_forced(&job->states, index)};
}

size_t queue_take(struct queue_job *job, uint16_t worker, struct queue_ticket *tickets, size_t max)
{
    int looks = SEARCH_LIMIT;
    int32_t index;
    size_t count = 0;

    assert(worker > 0);
    if (!is_ready(job)) return 0;
    while (count < max && job->states.counts[FRAME_QUEUED] > 0 && take_index(job, &index, &looks))
        tickets[count++] = begin_attempt(job, index, worker);
    if (count > 0) job->has_started = true;
    note_ready(job);
    return count;
}

// The ticket's job if the ticket owns its frame, else NULL.
static struct queue_job *find_owned(const struct queue *queue, const struct queue_ticket *ticket)
{
    struct queue_job *job = queue_find_job(queue, ticket->job);

    if (!job || ticket->index < 0 || ticket->index >= job->states.frame_count) return NULL;
    return frame_states_is_attempt(&job->states, ticket->index, ticket->attempt) ? job : NULL;
}

bool queue_owns(const struct queue *queue, const struct queue_ticket *ticket)
{
    return find_owned(queue, ticket) != NULL;
}

bool queue_begin_publish(struct queue *queue, const struct queue_ticket *ticket)
{
    struct queue_job *job = find_owned(queue, ticket);

    if (!job || frame_states_at(&job->states, ticket->index).is_publishing) return false;
    frame_states_set_publishing(&job->states, ticket->index);
    return true;
}

static bool finish_frame(struct queue *queue, const struct queue_ticket *ticket, enum frame_state state)
{
    struct queue_job *job = find_owned(queue, ticket);

    if (!job) return false;
    frame_states_set(&job->states, ticket->index, state);
    return true;
}

bool queue_succeed(struct queue *queue, const struct queue_ticket *ticket)
{
    return finish_frame(queue, ticket, FRAME_SUCCEEDED);
}

bool queue_skip(struct queue *queue, const struct queue_ticket *ticket)
{
    return finish_frame(queue, ticket, FRAME_SKIPPED);
}

bool queue_find_published(struct queue_job *job, int64_t index)
{
    if (frame_states_get(&job->states, index) != FRAME_QUEUED) return false;
    frame_states_set(&job->states, index, FRAME_SUCCEEDED);
    note_ready(job);
    return true;
}

// Queues the frame again; in a job that is canceled or failed it becomes that. Returns whether it is queued.
static bool requeue(struct queue_job *job, int32_t index)
{
    if (job->is_canceled || job->is_failed) {
        frame_states_set(&job->states, index, job->is_failed ? FRAME_FAILED : FRAME_CANCELED);
        return false;
    }
    frame_states_set(&job->states, index, FRAME_QUEUED);
    index_heap_add(&job->returned, index);
    note_ready(job);
    return true;
}

bool queue_fail(struct queue *queue, const struct queue_ticket *ticket, bool final, bool *is_final)
{
    struct queue_job *job = find_owned(queue, ticket);
    bool ended = true;

    if (!job) return false;
    if (job->is_canceled || !(final || frame_states_at(&job->states, ticket->index).tries >= queue->max_attempts))
        ended = !requeue(job, ticket->index);
    else
        frame_states_set(&job->states, ticket->index, FRAME_FAILED);
    if (is_final) *is_final = ended;
    return true;
}

bool queue_return(struct queue *queue, const struct queue_ticket *ticket)
{
    struct queue_job *job = find_owned(queue, ticket);

    if (!job) return false;
    frame_states_uncount_try(&job->states, ticket->index);
    requeue(job, ticket->index);
    return true;
}

void queue_set_priority(struct queue *queue, struct queue_job *job, int priority)
{
    assert(priority >= 0 && priority < QUEUE_PRIORITY_LIMIT);
    turns_set_ready(queue->turns, &job->turn, false);
    unlink_job(queue, job);
    job->priority = job->turn.priority = priority;
    link_job(queue, job);
    note_ready(job);
}

void queue_set_barred(struct queue *queue, struct queue_job *job, uint64_t barred)
{
    turns_set_ready(queue->turns, &job->turn, false);
    job->turn.barred = barred;
    note_ready(job);
}

void queue_pause(struct queue *queue, struct queue_job *job)
{
    job->is_paused = true;
    note_ready(job);
}

void queue_resume(struct queue *queue, struct queue_job *job)
{
    job->is_paused = false;
    note_ready(job);
}

bool queue_has_frame_to_cancel(const struct queue_job *job)
{
    return frame_states_can_end(&job->states);
}

void queue_set_block(struct queue *queue, struct queue_job *job, enum queue_block block)
{
    job->block = block;
    note_ready(job);
}

void queue_set_wait(struct queue_job *job, enum queue_wait wait)
{
    job->wait = wait;
    note_ready(job);
}

static void end_frames(struct queue_job *job, enum frame_state state)
{
    frame_states_end(&job->states, state);
    index_heap_finish(&job->returned);
    job->next_position = frame_order_length(&job->order, job->states.frame_count);
    note_ready(job);
}

void queue_cancel(struct queue *queue, struct queue_job *job)
{
    if (!queue_job_is_live(job)) return;
    job->is_canceled = true;
    end_frames(job, FRAME_CANCELED);
}

void queue_fail_job(struct queue *queue, struct queue_job *job)
{
    if (!queue_job_is_live(job)) return;
    job->is_failed = true;
    end_frames(job, FRAME_FAILED);
}

void queue_restore_end(struct queue_job *job, bool canceled, bool failed)
{
    if (!canceled && !failed) return;
    job->is_canceled = canceled;
    job->is_failed = failed;
    end_frames(job, failed ? FRAME_FAILED : FRAME_CANCELED);
}

int64_t queue_retry(struct queue_job *job, const struct frame_set *indices, int64_t first, int64_t end, bool is_forced)
{
    bool was_live = queue_job_is_live(job);
    int64_t count = frame_states_requeue(&job->states, indices, first, end, is_forced);

    if (count == 0) return 0;
    job->is_canceled = false;
    job->is_failed = false;
    if (!was_live) job->is_paused = false;
    job->has_started = job->states.counts[FRAME_QUEUED] < job->states.frame_count;
    // The search starts at the front and finds all queued frames, so none may be in the heap as well.
    index_heap_finish(&job->returned);
    job->next_position = 0;
    note_ready(job);
    return count;
}

void queue_force_frame(struct queue_job *job, int64_t index)
{
    frame_states_set_forced(&job->states, index);
}

int64_t queue_count(const struct queue *queue, enum frame_state state)
{
    return queue->counts[state];
}
