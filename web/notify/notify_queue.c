// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_queue.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

static void finish_item(struct notify_item *item)
{
    free(item->event);
    free(item->body);
}

static void line_destroy(struct notify_line *line)
{
    for (size_t i = 0; i < line->count; i++)
        finish_item(&line->items[i]);
    free(line->items);
    free(line->target);
    free(line->why);
    free(line);
}

void notify_queue_finish(struct notify_queue *queue)
{
    for (size_t i = 0; i < queue->count; i++)
        line_destroy(queue->lines[i]);
    free(queue->lines);
    *queue = (struct notify_queue){0};
}

static struct notify_line *find_line(struct notify_queue *queue, const char *target, bool is_webhook, int64_t owner_uid)
{
    struct notify_line *line;

    for (size_t i = 0; i < queue->count; i++) {
        line = queue->lines[i];
        if (line->is_webhook == is_webhook && (!is_webhook || line->owner_uid == owner_uid) &&
            strcmp(line->target, target) == 0)
            return line;
    }
    line = xcalloc(1, sizeof *line);
    line->target = xstrdup(target);
    line->is_webhook = is_webhook;
    line->owner_uid = owner_uid;
    queue->lines = xgrow(queue->lines, &queue->capacity, queue->count + 1, sizeof(struct notify_line *));
    queue->lines[queue->count++] = line;
    return line;
}

void notify_queue_add(struct notify_queue *queue, const char *target, bool is_webhook, struct notify_item *item)
{
    struct notify_line *line = find_line(queue, target, is_webhook, item->owner_uid);

    line->items = xgrow(line->items, &line->capacity, line->count + 1, sizeof *item);
    line->items[line->count++] = *item;
    *item = (struct notify_item){0};
}

static bool has_room(const struct notify_queue *queue, const struct notify_line *line)
{
    int all = 0, own = 0;

    for (size_t i = 0; i < queue->count && line->is_webhook; i++) {
        const struct notify_line *other = queue->lines[i];

        if (!other->is_webhook || other->state != NOTIFY_IS_SENT) continue;
        all++;
        own += other->owner_uid == line->owner_uid;
    }
    return all < NOTIFY_WEBHOOKS_AT_ONCE && own < NOTIFY_WEBHOOKS_OF_AN_OWNER;
}

struct notify_line *notify_queue_next(const struct notify_queue *queue, int64_t now_ms)
{
    for (size_t i = 0; i < queue->count; i++) {
        struct notify_line *line = queue->lines[i];

        if (line->state == NOTIFY_WAITS && line->due_ms <= now_ms && has_room(queue, line)) return line;
    }
    return NULL;
}

int64_t notify_queue_due_ms(const struct notify_queue *queue)
{
    int64_t due_ms = -1;

    for (size_t i = 0; i < queue->count; i++) {
        const struct notify_line *line = queue->lines[i];

        if (line->state == NOTIFY_WAITS && has_room(queue, line) && (due_ms < 0 || line->due_ms < due_ms))
            due_ms = line->due_ms;
    }
    return due_ms;
}

int64_t notify_wait_ms(int attempts)
{
    int64_t wait_ms = NOTIFY_FIRST_WAIT_MS;

    for (int i = 1; i < attempts && wait_ms < NOTIFY_LONGEST_WAIT_MS; i++)
        wait_ms *= 2;
    return wait_ms < NOTIFY_LONGEST_WAIT_MS ? wait_ms : NOTIFY_LONGEST_WAIT_MS;
}

void notify_queue_begin(struct notify_line *line)
{
    line->state = NOTIFY_IS_SENT;
}

void notify_queue_succeed(struct notify_line *line)
{
    line->state = NOTIFY_IS_OVER;
}

void notify_queue_give_up(struct notify_line *line, const char *why)
{
    line->state = NOTIFY_IS_OVER;
    free(line->why);
    line->why = xstrdup(why);
}

void notify_queue_fail(const struct notify_queue *queue, struct notify_line *line, int64_t now_ms, int64_t unix_ms,
                       const char *why)
{
    line->attempts++;
    line->due_ms = now_ms + notify_wait_ms(line->attempts);
    line->state = NOTIFY_WAITS;
    if (unix_ms - line->items[0].made_ms >= queue->keep_ms) notify_queue_give_up(line, why);
}

struct notify_line *notify_queue_find_over(const struct notify_queue *queue)
{
    for (size_t i = 0; i < queue->count; i++)
        if (queue->lines[i]->state == NOTIFY_IS_OVER) return queue->lines[i];
    return NULL;
}

static void remove_line(struct notify_queue *queue, struct notify_line *line)
{
    size_t i = 0;

    while (queue->lines[i] != line)
        i++;
    queue->count--;
    memmove(&queue->lines[i], &queue->lines[i + 1], (queue->count - i) * sizeof(struct notify_line *));
    line_destroy(line);
}

void notify_queue_leave(struct notify_queue *queue, struct notify_line *line)
{
    finish_item(&line->items[0]);
    line->count--;
    memmove(&line->items[0], &line->items[1], line->count * sizeof line->items[0]);
    line->attempts = 0;
    line->due_ms = 0;
    line->state = NOTIFY_WAITS;
    free(line->why);
    line->why = NULL;
    if (line->count == 0) remove_line(queue, line);
}
