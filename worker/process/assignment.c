// SPDX-License-Identifier: Apache-2.0
#include "worker/process/assignment.h"

#include "core/base/alloc.h"

#include <assert.h>
#include <stdlib.h>

struct held_job *held_job_create(void)
{
    return xcalloc(1, sizeof(struct held_job));
}

void held_job_destroy(struct held_job *job)
{
    if (!job) return;
    job_finish(&job->job);
    free(job->root);
    free(job->root_id);
    free(job->farm_id);
    free(job->node);
    free(job->owner);
    free(job->draft);
    free(job->fault);
    free(job->plan_of);
    free(job->preview);
    old_parts_finish(&job->old_parts);
    plan_mail_finish(&job->plans);
    free(job);
}

void assignment_finish(struct assignment *assignment)
{
    while (assignment->frames) {
        struct assignment_frame *frame = assignment->frames;

        assignment->frames = frame->next;
        free(frame);
    }
    while (assignment->jobs) {
        struct held_job *job = assignment->jobs;

        assignment->jobs = job->next;
        held_job_destroy(job);
    }
    *assignment = (struct assignment){0};
}

struct held_job *assignment_find_job(const struct assignment *assignment, int64_t id)
{
    for (struct held_job *job = assignment->jobs; job; job = job->next)
        if (job->id == id && !job->is_forgotten) return job;
    return NULL;
}

static void free_job_if_done(struct assignment *assignment, struct held_job *job)
{
    struct held_job **link = &assignment->jobs;

    if (!job->is_forgotten || job->frame_count > 0) return;
    while (*link != job)
        link = &(*link)->next;
    *link = job->next;
    held_job_destroy(job);
}

void assignment_add_job(struct assignment *assignment, struct held_job *job)
{
    assignment_forget_job(assignment, job->id);
    job->serial = ++assignment->job_count;
    job->next = assignment->jobs;
    assignment->jobs = job;
}

void assignment_forget_job(struct assignment *assignment, int64_t id)
{
    struct held_job *job = assignment_find_job(assignment, id);

    if (!job) return;
    job->is_forgotten = true;
    free_job_if_done(assignment, job);
}

struct assignment_frame *assignment_add_frame(struct assignment *assignment, int64_t job, int32_t frame, int attempt)
{
    struct held_job *held = assignment_find_job(assignment, job);
    struct assignment_frame **link = &assignment->frames;
    struct assignment_frame *added;

    if (!held) return NULL;
    added = xcalloc(1, sizeof *added);
    added->job = held;
    added->frame = frame;
    added->attempt = attempt;
    held->frame_count++;
    while (*link)
        link = &(*link)->next;
    *link = added;
    return added;
}

const struct assignment_frame *assignment_find_waiting(const struct assignment *assignment)
{
    for (const struct assignment_frame *frame = assignment->frames; frame; frame = frame->next)
        if (!frame->is_started) return frame;
    return NULL;
}

struct assignment_frame *assignment_start_frame(struct assignment *assignment)
{
    struct assignment_frame *frame = assignment->frames;

    while (frame && frame->is_started)
        frame = frame->next;
    if (!frame) return NULL;
    frame->is_started = true;
    return frame;
}

static void remove_frame(struct assignment *assignment, struct assignment_frame *frame)
{
    struct assignment_frame **link = &assignment->frames;
    struct held_job *job = frame->job;

    while (*link != frame)
        link = &(*link)->next;
    *link = frame->next;
    free(frame);
    job->frame_count--;
    free_job_if_done(assignment, job);
}

void assignment_end_frame(struct assignment *assignment, struct assignment_frame *frame)
{
    assert(frame->is_started);
    remove_frame(assignment, frame);
}

static bool is_of_job(const struct assignment_frame *frame, int64_t job)
{
    return job == ASSIGNMENT_ANY_JOB || frame->job->id == job;
}

bool assignment_drop_waiting(struct assignment *assignment, int64_t job, struct assignment_dropped *dropped)
{
    for (struct assignment_frame *frame = assignment->frames; frame; frame = frame->next) {
        if (frame->is_started || !is_of_job(frame, job)) continue;
        *dropped = (struct assignment_dropped){frame->job->id, frame->frame, frame->attempt};
        remove_frame(assignment, frame);
        return true;
    }
    return false;
}

void assignment_unwant_started(struct assignment *assignment, int64_t job)
{
    for (struct assignment_frame *frame = assignment->frames; frame; frame = frame->next)
        if (frame->is_started && is_of_job(frame, job)) frame->is_unwanted = true;
}
