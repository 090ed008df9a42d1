// Which notices wait for delivery, and which of too many is dropped. Pure.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { NOTICE_LIST_OWNER_LIMIT = 2000, NOTICE_LIST_LIMIT = 20000 };

struct notice_entry {
    int64_t id, owner_uid;
};

// The zero value is empty.
struct notice_list {
    struct notice_entry *entries; // owned; by ascending id
    size_t count, capacity;
    int64_t dropped; // how many were dropped
};

void notice_list_finish(struct notice_list *list);
// Adds a notice whose id is greater than any before. Over a limit the oldest of its owner is dropped, or of the owner
// who has most: `*dropped` is its id, else 0.
void notice_list_add(struct notice_list *list, int64_t id, int64_t owner_uid, int64_t *dropped);
bool notice_list_remove(struct notice_list *list, int64_t id); // false: there is none
