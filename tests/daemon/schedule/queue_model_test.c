// Compares the queue with a model that has no cursor, heap or counts, over random operations.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/queue.h"
#include "tests/daemon/schedule/retry_frames.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { JOB_LIMIT = 12, FRAME_LIMIT = 24, TICKET_LIMIT = 256, MAX_ATTEMPTS = 3, STEP_COUNT = 20 * 1000 };

struct model_frame {
    enum frame_state state;
    int attempt, tries;
    bool is_publishing, is_returned;
};

struct model_job {
    bool exists, is_paused, is_canceled, is_failed;
    int priority;
    int frame_count;
    struct frame_order order;
    struct model_frame frames[FRAME_LIMIT];
};

struct world {
    struct queue *queue;
    struct model_job jobs[JOB_LIMIT];          // the job of id index + 1
    struct queue_ticket tickets[TICKET_LIMIT]; // all tickets taken; the oldest are overwritten
    size_t ticket_count;
    uint64_t random;
};

static unsigned pick(struct world *world, unsigned count)
{
    world->random ^= world->random << 13;
    world->random ^= world->random >> 7;
    world->random ^= world->random << 17;
    return (unsigned)(world->random % count);
}

static int count_state(const struct model_job *job, enum frame_state state)
{
    int count = 0;

    for (int i = 0; i < job->frame_count; i++)
        count += job->frames[i].state == state;
    return count;
}

static bool is_live(const struct model_job *job)
{
    return !job->is_canceled && !job->is_failed && count_state(job, FRAME_QUEUED) + count_state(job, FRAME_RUNNING) > 0;
}

static int find_first_ready(const struct world *world)
{
    int best = -1;

    for (int i = 0; i < JOB_LIMIT; i++) {
        const struct model_job *job = &world->jobs[i];

        if (!job->exists || job->is_paused || !is_live(job) || count_state(job, FRAME_QUEUED) == 0) continue;
        if (best < 0 || job->priority > world->jobs[best].priority) best = i;
    }
    return best;
}

// Frames that come back are first, the lowest of them; then the order counts. -1: none is queued.
static int find_next_frame(const struct model_job *job)
{
    for (int i = 0; i < job->frame_count; i++)
        if (job->frames[i].state == FRAME_QUEUED && job->frames[i].is_returned) return i;
    for (int64_t i = 0; i < frame_order_length(&job->order, job->frame_count); i++) {
        int64_t index = frame_order_at(&job->order, job->frame_count, i);

        if (index >= 0 && job->frames[index].state == FRAME_QUEUED) return (int)index;
    }
    return -1;
}

static void take(struct world *world)
{
    struct queue_ticket tickets[6];
    size_t wanted = 1 + pick(world, 6);
    struct queue_job *next = queue_choose_job(world->queue, NULL);
    size_t count = next ? queue_take(next, 1, tickets, wanted) : 0;
    int ready = find_first_ready(world);
    size_t taken = 0;

    if (ready < 0) {
        assert_int_equal(count, 0);
        return;
    }
    for (int i; taken < wanted && (i = find_next_frame(&world->jobs[ready])) >= 0;) {
        struct model_frame *frame = &world->jobs[ready].frames[i];

        frame->is_returned = false;
        frame->state = FRAME_RUNNING;
        frame->attempt++;
        frame->tries++;
        assert_true(taken < count);
        assert_int_equal(tickets[taken].job, ready + 1);
        assert_int_equal(tickets[taken].index, i);
        assert_int_equal(tickets[taken].attempt, frame->attempt);
        world->tickets[world->ticket_count++ % TICKET_LIMIT] = tickets[taken++];
    }
    assert_int_equal(count, taken);
}

static struct model_frame *find_owned(struct world *world, const struct queue_ticket *ticket)
{
    struct model_job *job = &world->jobs[ticket->job - 1];
    struct model_frame *frame = &job->frames[ticket->index];

    return job->exists && frame->state == FRAME_RUNNING && frame->attempt == ticket->attempt ? frame : NULL;
}

static void end(struct model_frame *frame, enum frame_state state)
{
    frame->state = state;
    frame->is_publishing = false;
}

static void give_back(const struct model_job *job, struct model_frame *frame)
{
    end(frame, job->is_failed ? FRAME_FAILED : job->is_canceled ? FRAME_CANCELED : FRAME_QUEUED);
    frame->is_returned = frame->state == FRAME_QUEUED;
}

// Any ticket ever taken: most of them own nothing any more.
static void answer(struct world *world)
{
    size_t held = world->ticket_count < TICKET_LIMIT ? world->ticket_count : TICKET_LIMIT;
    struct queue_ticket ticket;
    struct model_frame *frame;
    const struct model_job *job;
    bool final = pick(world, 8) == 0;

    if (held == 0) return;
    ticket = world->tickets[pick(world, (unsigned)held)];
    frame = find_owned(world, &ticket);
    job = &world->jobs[ticket.job - 1];
    assert_int_equal(queue_owns(world->queue, &ticket), frame != NULL);
    switch (pick(world, 5)) {
    case 0:
        assert_int_equal(queue_begin_publish(world->queue, &ticket), frame && !frame->is_publishing);
        if (frame) frame->is_publishing = true;
        break;
    case 1:
        assert_int_equal(queue_succeed(world->queue, &ticket), frame != NULL);
        if (frame) end(frame, FRAME_SUCCEEDED);
        break;
    case 2:
        assert_int_equal(queue_skip(world->queue, &ticket), frame != NULL);
        if (frame) end(frame, FRAME_SKIPPED);
        break;
    case 3:
        assert_int_equal(queue_fail(world->queue, &ticket, final, NULL), frame != NULL);
        if (!frame) break;
        if (!job->is_canceled && (final || frame->tries >= MAX_ATTEMPTS))
            end(frame, FRAME_FAILED);
        else
            give_back(job, frame);
        break;
    default:
        assert_int_equal(queue_return(world->queue, &ticket), frame != NULL);
        if (!frame) break;
        frame->tries--;
        give_back(job, frame);
        break;
    }
}

static void add(struct world *world, int at)
{
    struct model_job *job = &world->jobs[at];
    struct frame_range range = {0};
    char text[32];

    *job = (struct model_job){.exists = true,
                              .is_paused = pick(world, 4) == 0,
                              .priority = (int)pick(world, 4) * 30,
                              .frame_count = 1 + (int)pick(world, FRAME_LIMIT)};
    for (int count = (int)pick(world, 4); job->order.count < count; job->order.count++)
        job->order.stages[job->order.count] = (int32_t)pick(world, 8) - 2; // 1 is every frame
    snprintf(text, sizeof text, "%d-0", job->frame_count - 1);
    assert_true(frame_range_parse(&range, text, NULL));
    queue_add_job(world->queue, &(struct queue_job_params){.id = at + 1,
                                                           .frames = &range,
                                                           .priority = job->priority,
                                                           .is_paused = job->is_paused,
                                                           .order = &job->order});
}

static void stop(struct model_job *job, enum frame_state state)
{
    if (!is_live(job)) return;
    *(state == FRAME_FAILED ? &job->is_failed : &job->is_canceled) = true;
    for (int i = 0; i < job->frame_count; i++) {
        struct model_frame *frame = &job->frames[i];

        if (frame->state == FRAME_QUEUED || (frame->state == FRAME_RUNNING && !frame->is_publishing)) end(frame, state);
    }
}

static void retry(struct world *world, struct model_job *job, struct queue_job *real)
{
    unsigned states = pick(world, 1u << FRAME_STATE_COUNT);
    bool was_live = is_live(job);
    int count = 0;

    for (int i = 0; i < job->frame_count; i++) {
        struct model_frame *frame = &job->frames[i];

        if (!(states >> frame->state & 1) || frame->state == FRAME_QUEUED || frame->state == FRAME_RUNNING) continue;
        end(frame, FRAME_QUEUED);
        frame->tries = 0;
        count++;
    }
    for (int i = 0; i < job->frame_count && count > 0; i++)
        job->frames[i].is_returned = false; // the search begins anew
    if (count > 0) job->is_canceled = job->is_failed = false;
    if (count > 0 && !was_live) job->is_paused = false;
    assert_int_equal(retry_frames(real, states, NULL), count);
}

static void command(struct world *world)
{
    int at = (int)pick(world, JOB_LIMIT);
    struct model_job *job = &world->jobs[at];
    struct queue_job *real = queue_find_job(world->queue, at + 1);

    assert_int_equal(real != NULL, job->exists);
    if (!real) {
        add(world, at);
        return;
    }
    switch (pick(world, 8)) {
    case 0:
        job->is_paused = true;
        queue_pause(world->queue, real);
        break;
    case 1:
    case 2:
        job->is_paused = false;
        queue_resume(world->queue, real);
        break;
    case 3:
        job->priority = (int)pick(world, 4) * 30;
        queue_set_priority(world->queue, real, job->priority);
        break;
    case 4:
        stop(job, FRAME_CANCELED);
        queue_cancel(world->queue, real);
        break;
    case 5:
        stop(job, FRAME_FAILED);
        queue_fail_job(world->queue, real);
        break;
    case 6:
        retry(world, job, real);
        break;
    default:
        if (is_live(job)) break;
        // Attempt numbers of a removed job start again: its tickets are removed here too.
        for (size_t i = 0; i < TICKET_LIMIT; i++)
            if (world->tickets[i].job == at + 1)
                world->tickets[i] = (struct queue_ticket){.job = at + 1, .attempt = -1};
        job->exists = false;
        queue_remove_job(world->queue, real);
        break;
    }
}

static void compare_job(const struct model_job *job, const struct queue_job *real)
{
    for (int i = 0; i < job->frame_count; i++) {
        const struct queue_frame frame = frame_states_at(&real->states, i);

        assert_int_equal(frame.state, job->frames[i].state);
        assert_int_equal(frame.attempt, job->frames[i].attempt);
        assert_int_equal(frame.is_publishing, job->frames[i].is_publishing);
        assert_int_equal(frame.worker != 0, job->frames[i].state == FRAME_RUNNING);
    }
    for (int state = 0; state < FRAME_STATE_COUNT; state++)
        assert_int_equal(real->states.counts[state], count_state(job, (enum frame_state)state));
    assert_int_equal(queue_job_is_live(real), is_live(job));
    assert_int_equal(real->is_paused, job->is_paused);
}

static void compare(const struct world *world)
{
    int64_t totals[FRAME_STATE_COUNT] = {0};
    const struct queue_job *previous = NULL;
    int listed = 0;

    for (const struct queue_job *real = queue_first_job(world->queue); real; previous = real, real = real->next) {
        const struct model_job *job = &world->jobs[real->id - 1];

        assert_true(job->exists);
        assert_ptr_equal(real->previous, previous);
        assert_true(!previous || previous->priority > real->priority ||
                    (previous->priority == real->priority && previous->id < real->id));
        compare_job(job, real);
        for (int state = 0; state < FRAME_STATE_COUNT; state++)
            totals[state] += real->states.counts[state];
        listed++;
    }
    for (int i = 0; i < JOB_LIMIT; i++)
        listed -= world->jobs[i].exists;
    assert_int_equal(listed, 0);
    for (int state = 0; state < FRAME_STATE_COUNT; state++)
        assert_int_equal(queue_count(world->queue, (enum frame_state)state), totals[state]);
}

// Running frames are lost and every job is resumed: then each frame must end.
static void drain(struct world *world)
{
    struct queue_ticket tickets[FRAME_LIMIT];

    for (struct queue_job *job = queue_first_job(world->queue); job; job = job->next) {
        queue_resume(world->queue, job);
        for (int32_t i = 0; i < job->states.frame_count; i++) {
            struct queue_ticket ticket = {
                .job = job->id, .index = i, .attempt = frame_states_at(&job->states, i).attempt};

            queue_fail(world->queue, &ticket, false, NULL);
        }
    }
    for (struct queue_job *next; (next = queue_choose_job(world->queue, NULL));) {
        size_t count = queue_take(next, 1, tickets, FRAME_LIMIT);

        assert_true(count > 0);
        for (size_t i = 0; i < count; i++)
            assert_true(queue_succeed(world->queue, &tickets[i]));
    }
    assert_int_equal(queue_count(world->queue, FRAME_QUEUED), 0);
    assert_int_equal(queue_count(world->queue, FRAME_RUNNING), 0);
}

static void queue_agrees_with_the_model(void **state)
{
    for (uint64_t seed = 1; seed <= 5; seed++) {
        struct world world = {.queue = queue_create(MAX_ATTEMPTS), .random = seed * 0x9e3779b97f4a7c15u};

        for (int step = 0; step < STEP_COUNT; step++) {
            switch (pick(&world, 10)) {
            case 0:
                command(&world);
                break;
            case 1:
            case 2:
            case 3:
                take(&world);
                break;
            default:
                answer(&world);
                break;
            }
            if (step % 4 == 0) compare(&world);
        }
        drain(&world);
        queue_destroy(world.queue);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(queue_agrees_with_the_model)};

    return cmocka_run_group_tests(tests, NULL, NULL);
}
