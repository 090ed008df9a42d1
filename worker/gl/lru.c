// SPDX-License-Identifier: Apache-2.0
#include "worker/gl/lru.h"

#include <assert.h>
#include <string.h>

void lru_begin(struct lru *lru)
{
    ++lru->moment;
}

int lru_find(struct lru *lru, const char *key)
{
    for (int i = 0; i < lru->capacity; ++i)
        if (lru->entries[i].key[0] && strcmp(lru->entries[i].key, key) == 0) {
            lru->entries[i].used = lru->moment;
            return i;
        }
    return -1;
}

int lru_make_room(struct lru *lru, size_t size_bytes, lru_drop *drop, void *user)
{
    assert(lru->capacity <= LRU_LIMIT);
    for (;;) {
        int oldest = -1, empty = -1;
        size_t idle_bytes = size_bytes;

        for (int i = 0; i < lru->capacity; ++i) {
            if (!lru->entries[i].key[0]) {
                empty = i;
                continue;
            }
            if (lru->entries[i].used == lru->moment) continue;
            idle_bytes += lru->entries[i].size_bytes;
            if (oldest < 0 || lru->entries[i].used < lru->entries[oldest].used) oldest = i;
        }
        if (oldest < 0 || (empty >= 0 && idle_bytes <= lru->idle_bytes_limit)) {
            assert(empty >= 0);
            return empty;
        }
        lru_remove(lru, oldest, drop, user);
    }
}

void lru_put(struct lru *lru, int index, const char *key, size_t size_bytes)
{
    lru->entries[index].size_bytes = size_bytes;
    lru->entries[index].used = lru->moment;
    memcpy(lru->entries[index].key, key, HASH_TEXT_SIZE);
}

void lru_remove(struct lru *lru, int index, lru_drop *drop, void *user)
{
    if (!lru->entries[index].key[0]) return;
    drop(user, index);
    memset(&lru->entries[index], 0, sizeof lru->entries[index]);
}

void lru_clear(struct lru *lru, lru_drop *drop, void *user)
{
    for (int i = 0; i < lru->capacity; ++i)
        lru_remove(lru, i, drop, user);
}
