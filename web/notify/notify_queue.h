// What is to be delivered, in a line for each target: in order, one at a time, again after a while. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    NOTIFY_FIRST_WAIT_MS = 1000, // before the second attempt; then twice as long each time
    NOTIFY_LONGEST_WAIT_MS = 600 * 1000,
    NOTIFY_WEBHOOKS_AT_ONCE = 16,   // to addresses that jobs name
    NOTIFY_WEBHOOKS_OF_AN_OWNER = 2 // likewise
};

// One notice of the daemon.
struct notify_item {
    int64_t id, owner_uid, made_ms; // made: unix time
    char *event, *body;             // owned
};

enum notify_state {
    NOTIFY_WAITS,
    NOTIFY_IS_SENT, // an attempt is under way
    NOTIFY_IS_OVER  // it is delivered or given up, and the daemon does not know yet
};

// The first item is the one that is delivered. Those of a target by its name are one line, those of an address one for
// each owner who named it.
struct notify_line {
    char *target; // owned; a name or an address
    bool is_webhook;
    int64_t owner_uid;         // of an address
    struct notify_item *items; // owned
    size_t count, capacity;
    enum notify_state state;
    int attempts;   // of the first item
    int64_t due_ms; // monotonic; of its next attempt
    char *why;      // owned; why it was given up; NULL: it was not
};

// The zero value is empty.
struct notify_queue {
    struct notify_line **lines; // owned
    size_t count, capacity;
    int64_t keep_ms; // so long after it was made an item is given up
};

void notify_queue_finish(struct notify_queue *queue);
// The item moves in.
void notify_queue_add(struct notify_queue *queue, const char *target, bool is_webhook, struct notify_item *item);
// A line whose first item may be sent now; NULL: none.
struct notify_line *notify_queue_next(const struct notify_queue *queue, int64_t now_ms);
// When the next item that waits is due; -1: none waits.
int64_t notify_queue_due_ms(const struct notify_queue *queue);
void notify_queue_begin(struct notify_line *line);
void notify_queue_succeed(struct notify_line *line);
void notify_queue_give_up(struct notify_line *line, const char *why);
// The attempt failed, and another follows, unless the item has been there for too long. `unix_ms` is the time now.
void notify_queue_fail(const struct notify_queue *queue, struct notify_line *line, int64_t now_ms, int64_t unix_ms,
                       const char *why);
struct notify_line *notify_queue_find_over(const struct notify_queue *queue); // NULL: none
// The daemon knows: the item leaves. The line is freed when it was the last.
void notify_queue_leave(struct notify_queue *queue, struct notify_line *line);

int64_t notify_wait_ms(int attempts); // after so many failed attempts, from 1
