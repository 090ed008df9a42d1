// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/queue.h"

#include "core/base/alloc.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

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
    free(job->states);
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
    return job->counts[FRAME_QUEUED] > 0 && !job->is_paused && job->block == QUEUE_OPEN && !job->is_canceled &&
           !job->is_failed;
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
                                       .owner = turns_find_owner(queue->turns, params->owner_uid)},
                              .frames = *params->frames,
                              .priority = params->priority,
                              .is_paused = params->is_paused,
                              .queue = queue};
    *params->frames = (struct frame_range){0};
    if (params->order) job->order = *params->order;
    job->frame_count = frame_range_count(&job->frames);
    job->states = xcalloc((size_t)job->frame_count, sizeof job->states[0]);
    job->counts[FRAME_QUEUED] = job->frame_count;
    queue->counts[FRAME_QUEUED] += job->frame_count;

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

    for (int state = 0; state < FRAME_STATE_COUNT; state++)
        queue->counts[state] -= job->counts[state];
    turns_set_ready(queue->turns, &job->turn, false);
    unlink_job(queue, job);
    queue->slot_count--;
    memmove(&queue->slots[slot], &queue->slots[slot + 1], (queue->slot_count - slot) * sizeof queue->slots[0]);
    destroy_job(job);
}

// Every change of a frame's state is made here, so that the counts are always right.
static void set_state(struct queue_job *job, int64_t index, enum frame_state state)
{
    struct queue_frame *frame = &job->states[index];

    job->counts[frame->state]--;
    job->queue->counts[frame->state]--;
    frame->state = (uint8_t)state;
    job->counts[state]++;
    job->queue->counts[state]++;
    job->missed_count -= frame->is_missed;
    frame->is_missed = false;
    if (state != FRAME_QUEUED && state != FRAME_RUNNING) frame->is_forced = false;
    if (state != FRAME_RUNNING) {
        frame->worker = 0;
        frame->is_publishing = false;
    }
}

void queue_note_missed(struct queue_job *job, int64_t index)
{
    struct queue_frame *frame = &job->states[index];

    assert(frame->state == FRAME_SUCCEEDED || frame->state == FRAME_SKIPPED);
    job->missed_count += !frame->is_missed;
    frame->is_missed = true;
}

void queue_restore_frame(struct queue_job *job, int64_t index, enum frame_state state, int attempts)
{
    assert(index >= 0 && index < job->frame_count && state != FRAME_RUNNING);
    set_state(job, index, state);
    job->states[index].attempt = attempts;
    job->states[index].tries = (uint16_t)(attempts < 0 ? 0 : attempts < UINT16_MAX ? attempts : UINT16_MAX);
    if (state != FRAME_QUEUED) job->has_started = true;
    note_ready(job);
}

enum job_state queue_job_state(const struct queue_job *job)
{
    if (job->is_failed) return JOB_FAILED;
    if (job->is_canceled) return JOB_CANCELED;
    if (job->counts[FRAME_QUEUED] == 0 && job->counts[FRAME_RUNNING] == 0) {
        if (job->counts[FRAME_FAILED] > 0) return JOB_FAILED;
        return job->counts[FRAME_CANCELED] > 0 ? JOB_CANCELED : JOB_SUCCEEDED;
    }
    if (job->is_paused || job->block == QUEUE_AWAY) return JOB_PAUSED;
    return job->has_started ? JOB_RUNNING : JOB_QUEUED;
}

bool queue_job_is_live(const struct queue_job *job)
{
    enum job_state state = queue_job_state(job);

    return state == JOB_QUEUED || state == JOB_RUNNING || state == JOB_PAUSED;
}

struct queue_job *queue_choose_job(const struct queue *queue, const struct turns_seat *seat)
{
    struct turns_job *turn = turns_choose(queue->turns, seat ? seat : &(struct turns_seat){0});

    return turn ? (struct queue_job *)((char *)turn - offsetof(struct queue_job, turn)) : NULL;
}

// The job must have a queued frame.
static int32_t take_index(struct queue_job *job)
{
    int32_t index;

    if (index_heap_take(&job->returned, &index)) return index;
    do {
        index = (int32_t)frame_order_at(&job->order, job->frame_count, job->next_position++);
    } while (index < 0 || job->states[index].state != FRAME_QUEUED);
    return index;
}

size_t queue_take(struct queue_job *job, uint16_t worker, struct queue_ticket *tickets, size_t max)
{
    size_t count = 0;

    assert(worker > 0);
    if (!is_ready(job)) return 0;
    while (count < max && job->counts[FRAME_QUEUED] > 0) {
        int32_t index = take_index(job);
        struct queue_frame *frame = &job->states[index];

        set_state(job, index, FRAME_RUNNING);
        frame->attempt++;
        frame->tries++;
        frame->worker = worker;
        tickets[count++] = (struct queue_ticket){.job = job->id,
                                                 .frame = frame_range_at(&job->frames, index),
                                                 .index = index,
                                                 .attempt = frame->attempt,
                                                 .is_forced = frame->is_forced};
    }
    if (count > 0) job->has_started = true;
    note_ready(job);
    return count;
}

// The ticket's job if the ticket owns its frame, else NULL.
static struct queue_job *find_owned(const struct queue *queue, const struct queue_ticket *ticket)
{
    struct queue_job *job = queue_find_job(queue, ticket->job);
    const struct queue_frame *frame;

    if (!job || ticket->index < 0 || ticket->index >= job->frame_count) return NULL;
    frame = &job->states[ticket->index];
    return frame->state == FRAME_RUNNING && frame->attempt == ticket->attempt ? job : NULL;
}

bool queue_owns(const struct queue *queue, const struct queue_ticket *ticket)
{
    return find_owned(queue, ticket) != NULL;
}

bool queue_begin_publish(struct queue *queue, const struct queue_ticket *ticket)
{
    struct queue_job *job = find_owned(queue, ticket);

    if (!job || job->states[ticket->index].is_publishing) return false;
    job->states[ticket->index].is_publishing = true;
    return true;
}

static bool finish_frame(struct queue *queue, const struct queue_ticket *ticket, enum frame_state state)
{
    struct queue_job *job = find_owned(queue, ticket);

    if (!job) return false;
    set_state(job, ticket->index, state);
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

// Queues the frame again; in a job that is canceled or failed it becomes that. Returns whether it is queued.
static bool requeue(struct queue_job *job, int32_t index)
{
    if (job->is_canceled || job->is_failed) {
        set_state(job, index, job->is_failed ? FRAME_FAILED : FRAME_CANCELED);
        return false;
    }
    set_state(job, index, FRAME_QUEUED);
    index_heap_add(&job->returned, index);
    note_ready(job);
    return true;
}

bool queue_fail(struct queue *queue, const struct queue_ticket *ticket, bool final, bool *is_final)
{
    struct queue_job *job = find_owned(queue, ticket);
    bool ended = true;

    if (!job) return false;
    if (job->is_canceled || !(final || job->states[ticket->index].tries >= queue->max_attempts))
        ended = !requeue(job, ticket->index);
    else
        set_state(job, ticket->index, FRAME_FAILED);
    if (is_final) *is_final = ended;
    return true;
}

bool queue_return(struct queue *queue, const struct queue_ticket *ticket)
{
    struct queue_job *job = find_owned(queue, ticket);

    if (!job) return false;
    if (job->states[ticket->index].tries > 0) job->states[ticket->index].tries--;
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

static bool would_end(const struct queue_frame *frame)
{
    return frame->state == FRAME_QUEUED || (frame->state == FRAME_RUNNING && !frame->is_publishing);
}

bool queue_has_frame_to_cancel(const struct queue_job *job)
{
    bool found = false;

    for (int64_t i = 0; i < job->frame_count && !found; i++)
        found = would_end(&job->states[i]);
    return found;
}

void queue_set_block(struct queue *queue, struct queue_job *job, enum queue_block block)
{
    job->block = block;
    note_ready(job);
}

static void end_frames(struct queue_job *job, enum frame_state state)
{
    for (int64_t i = 0; i < job->frame_count; i++)
        if (would_end(&job->states[i])) set_state(job, i, state);
    index_heap_finish(&job->returned);
    job->next_position = frame_order_length(&job->order, job->frame_count);
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

void queue_retry(struct queue *queue, struct queue_job *job, const int32_t *indices, size_t count)
{
    bool was_live = queue_job_is_live(job);

    if (count == 0) return;
    for (size_t i = 0; i < count; i++) {
        set_state(job, indices[i], FRAME_QUEUED);
        job->states[indices[i]].tries = 0;
    }
    job->is_canceled = false;
    job->is_failed = false;
    if (!was_live) job->is_paused = false;
    job->has_started = job->counts[FRAME_QUEUED] < job->frame_count;
    // The search starts at the front and finds all queued frames, so none may be in the heap as well.
    index_heap_finish(&job->returned);
    job->next_position = 0;
    note_ready(job);
}

void queue_force_frame(struct queue_job *job, int64_t index)
{
    assert(job->states[index].state == FRAME_QUEUED);
    job->states[index].is_forced = true;
}

int64_t queue_count(const struct queue *queue, enum frame_state state)
{
    return queue->counts[state];
}
