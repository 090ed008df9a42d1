// SPDX-License-Identifier: Apache-2.0
#include "worker/process/plan_post.h"

#include "core/base/error.h"
#include "worker/process/plan_mail.h"
#include "worker/process/report.h"
#include "worker/process/worker.h"

#include <pthread.h>
#include <time.h>

enum { TICK_MS = 200 };

static bool is_unwanted(const struct plan_post *post)
{
    return post->worker->is_abandoned || post->frame->is_unwanted;
}

static struct plan_letter *find_letter(const struct plan_post *post, const char *key)
{
    return plan_mail_find(&post->frame->job->plans, key);
}

// Makes the frame's question the latest one.
static void begin_question(const struct plan_post *post, const char *key)
{
    struct plan_letter *letter;

    pthread_mutex_lock(&post->worker->lock);
    letter = find_letter(post, key);
    letter->frame = post->frame->frame;
    letter->attempt = post->frame->attempt;
    letter->said = PLAN_SAID_NOTHING;
    pthread_mutex_unlock(&post->worker->lock);
}

// Waiting is progress: the program that is asked knows what it waits for. Its clock is none that somebody sets back.
static void wait_a_while(struct worker *worker)
{
    struct timespec until;

    clock_gettime(CLOCK_MONOTONIC, &until);
    until.tv_nsec += TICK_MS * 1000000L;
    until.tv_sec += until.tv_nsec / 1000000000L;
    until.tv_nsec %= 1000000000L;
    (void)pthread_cond_clockwait(&worker->changed, &worker->lock, CLOCK_MONOTONIC, &until);
    worker_advance(worker);
}

// Called and left with the lock held. NULL: the frame is no longer wanted.
static struct plan_letter *wait_for_answer(const struct plan_post *post, const char *key)
{
    struct plan_letter *letter = find_letter(post, key);
    bool is_waiting = false;

    while (letter->said == PLAN_SAID_NOTHING || letter->said == PLAN_SAID_WAIT) {
        if (is_unwanted(post)) return NULL;
        if (letter->said == PLAN_SAID_WAIT && !is_waiting) {
            is_waiting = true;
            pthread_mutex_unlock(&post->worker->lock);
            post->on_wait(post->user);
            pthread_mutex_lock(&post->worker->lock);
            continue;
        }
        wait_a_while(post->worker);
    }
    return letter;
}

static enum plan_source_answer read_answer(const struct plan_letter *letter, struct error *error)
{
    if (!letter) return PLAN_SOURCE_STOPPED;
    if (letter->said == PLAN_SAID_MAKE) return PLAN_SOURCE_MAKE;
    if (letter->said == PLAN_SAID_PLAN) return PLAN_SOURCE_HAS;
    error_set(error, "%s", letter->refusal);
    return PLAN_SOURCE_REFUSED;
}

static enum plan_source_answer find(void *user, const char *key, int64_t *number, struct plan_json *plan,
                                    struct error *error)
{
    const struct plan_post *post = user;
    enum plan_source_answer answer = PLAN_SOURCE_HAS;
    const struct plan_letter *letter;
    bool is_told;

    pthread_mutex_lock(&post->worker->lock);
    is_told = find_letter(post, key)->number > 0;
    pthread_mutex_unlock(&post->worker->lock);
    if (!is_told) {
        begin_question(post, key);
        report_plan_wanted(&post->worker->connection, post->frame, key);
    }
    pthread_mutex_lock(&post->worker->lock);
    if (!is_told) answer = read_answer(wait_for_answer(post, key), error);
    letter = find_letter(post, key);
    if (answer == PLAN_SOURCE_HAS && letter->number != *number) {
        *number = letter->number;
        *plan = letter->plan;
    }
    pthread_mutex_unlock(&post->worker->lock);
    return answer;
}

static enum plan_source_answer keep(void *user, const char *key, int64_t missed, const struct plan_json *plan,
                                    int64_t *number, struct error *error)
{
    const struct plan_post *post = user;
    const struct plan_letter *letter;
    enum plan_source_answer answer;

    begin_question(post, key);
    report_plan_made(&post->worker->connection, post->frame, &(struct report_plan){key, missed, plan});
    pthread_mutex_lock(&post->worker->lock);
    letter = wait_for_answer(post, key);
    answer = read_answer(letter, error);
    if (answer == PLAN_SOURCE_HAS) *number = letter->said_number;
    pthread_mutex_unlock(&post->worker->lock);
    return answer;
}

struct plan_source plan_post_open(struct plan_post *post)
{
    return (struct plan_source){.find = find, .keep = keep, .user = post};
}
