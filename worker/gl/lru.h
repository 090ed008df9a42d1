// Keeps a few things by key; where room is needed, the least recently used one is dropped.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

#include <stddef.h>
#include <stdint.h>

enum { LRU_LIMIT = 104 };

// The owner has the things themselves, in an array with the same indices.
struct lru {
    int capacity;            // at most LRU_LIMIT, and more than are in use at once
    size_t idle_bytes_limit; // the most bytes kept that are not in use
    uint64_t moment;
    struct {
        char key[HASH_TEXT_SIZE]; // empty: nothing is kept here
        size_t size_bytes;
        uint64_t used; // the last moment that needed it
    } entries[LRU_LIMIT];
};

// Releases the owner's thing at `index`.
typedef void lru_drop(void *user, int index);

// Begins a moment, a frame for example, in which nothing is in use yet.
void lru_begin(struct lru *lru);
// Returns the index of the thing with this key, which is then in use; -1 when it is not kept.
int lru_find(struct lru *lru, const char *key);
// Returns the index of an empty entry, after dropping things that are not in use until `size_bytes` more fit.
int lru_make_room(struct lru *lru, size_t size_bytes, lru_drop *drop, void *user);
// Keeps a thing at an index from lru_make_room, in use.
void lru_put(struct lru *lru, int index, const char *key, size_t size_bytes);
// Drops the thing at `index`, if there is one.
void lru_remove(struct lru *lru, int index, lru_drop *drop, void *user);
void lru_clear(struct lru *lru, lru_drop *drop, void *user);
