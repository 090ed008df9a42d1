// SPDX-License-Identifier: Apache-2.0
#include "web/pictures/picture_queue.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

static size_t count_of_user(const struct picture_queue *queue, int64_t user)
{
    size_t count = 0;

    for (const struct picture_task *task = queue->tasks; task; task = task->next)
        for (const struct picture_waiter *waiter = task->waiters; waiter; waiter = waiter->next)
            count += waiter->user == user;
    return count;
}

// A task that is being made has a key as long as somebody waits for it.
static struct picture_task *find_task(const struct picture_queue *queue, const char *key)
{
    for (struct picture_task *task = queue->tasks; task; task = task->next)
        if (task->waiters && !strcmp(task->waiters->key, key)) return task;
    return NULL;
}

static void join(struct picture_queue *queue, struct picture_task *task, struct picture_waiter *waiter)
{
    struct picture_waiter **link = &task->waiters;

    while (*link)
        link = &(*link)->next;
    *link = waiter;
    waiter->task = task;
    waiter->next = NULL;
    queue->waiter_count++;
}

bool picture_queue_add(struct picture_queue *queue, struct picture_waiter *waiter, bool *is_new)
{
    struct picture_task *task = find_task(queue, waiter->key), **link = &queue->tasks;

    *is_new = false;
    if (queue->waiter_count >= PICTURE_WAIT_LIMIT || count_of_user(queue, waiter->user) >= PICTURE_USER_WAIT_LIMIT)
        return false;
    if (!task) {
        while (*link)
            link = &(*link)->next;
        task = *link = xcalloc(1, sizeof *task);
        task->user = waiter->user;
        *is_new = true;
    }
    join(queue, task, waiter);
    return true;
}

static uint64_t find_turn(const struct picture_queue *queue, int64_t user)
{
    for (size_t i = 0; i < PICTURE_QUEUE_USERS; i++)
        if (queue->users[i].turn > 0 && queue->users[i].user == user) return queue->users[i].turn;
    return 0;
}

// Of more users than are remembered, the one whose turn is longest ago is forgotten.
static void note_turn(struct picture_queue *queue, int64_t user)
{
    size_t place = 0;

    for (size_t i = 0; i < PICTURE_QUEUE_USERS; i++) {
        if (queue->users[i].turn > 0 && queue->users[i].user == user) {
            place = i;
            break;
        }
        if (queue->users[i].turn < queue->users[place].turn) place = i;
    }
    queue->users[place].user = user;
    queue->users[place].turn = ++queue->turn;
}

struct picture_task *picture_queue_take(struct picture_queue *queue)
{
    struct picture_task *next = NULL;

    for (struct picture_task *task = queue->tasks; task; task = task->next) {
        if (task->is_made) continue;
        if (!next || find_turn(queue, task->user) < find_turn(queue, next->user)) next = task;
    }
    if (!next) return NULL;
    next->is_made = true;
    note_turn(queue, next->user);
    return next;
}

static void remove_task(struct picture_queue *queue, struct picture_task *task)
{
    struct picture_task **link = &queue->tasks;

    while (*link != task)
        link = &(*link)->next;
    *link = task->next;
    free(task);
}

void picture_queue_drop(struct picture_queue *queue, struct picture_waiter *waiter)
{
    struct picture_task *task = waiter->task;
    struct picture_waiter **link;

    if (!task) return;
    for (link = &task->waiters; *link != waiter;)
        link = &(*link)->next;
    *link = waiter->next;
    waiter->task = NULL;
    waiter->next = NULL;
    queue->waiter_count--;
    if (!task->waiters && !task->is_made) remove_task(queue, task);
}

struct picture_waiter *picture_queue_end(struct picture_queue *queue, struct picture_task *task)
{
    struct picture_waiter *waiters = task->waiters;

    for (struct picture_waiter *waiter = waiters; waiter; waiter = waiter->next) {
        waiter->task = NULL;
        queue->waiter_count--;
    }
    remove_task(queue, task);
    return waiters;
}
