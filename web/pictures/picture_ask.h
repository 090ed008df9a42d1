// A question for a picture or an explanation on its way to the answer, and lists of them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/error.h"
#include "web/pictures/picture_cache.h"
#include "web/pictures/picture_queue.h"
#include "web/pictures/picture_status.h"

#include <stdbool.h>
#include <stdint.h>

struct picture_look;

// Its files are looked at, then it may wait for a maker, then it is answered.
struct picture_ask {
    struct picture_waiter waiter;
    char *known; // owned; the value of If-None-Match, or NULL
    void *user;
    struct picture_look *looking; // borrowed: its thread has it, or may have it for ever; NULL: it has ended
    struct picture_look *look;    // owned; NULL: it has not ended
    int64_t until_ms;             // it may look no longer
    struct picture_file file;
    enum picture_status status;
    struct error error;
    bool is_answered;
    struct picture_ask *next; // in its list
};

struct picture_ask_list {
    struct picture_ask *first, **end;
};

struct picture_ask *picture_ask_of(struct picture_waiter *waiter);
void picture_ask_free(struct picture_ask *ask);

void picture_ask_list_init(struct picture_ask_list *list);
void picture_ask_list_add(struct picture_ask_list *list, struct picture_ask *ask); // as the last one
struct picture_ask *picture_ask_list_take(struct picture_ask_list *list);          // NULL: it is empty
// Nothing happens where it is not in the list.
void picture_ask_list_remove(struct picture_ask_list *list, struct picture_ask *ask);
