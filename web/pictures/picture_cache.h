// Pictures that were made, as files in a folder of limited size. What is used least recently goes first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

struct error;

enum { PICTURE_FACTS_LIMIT = 400, PICTURE_BODY_LIMIT = 64 * 1024 * 1024 }; // bytes

// A picture that is open. What is removed from the cache stays readable until it is closed.
struct picture_file {
    int fd; // owned; the body begins at its start
    uint64_t body_bytes;
    char facts[PICTURE_FACTS_LIMIT + 1]; // a text of the caller's, in one line
};

void picture_file_close(struct picture_file *file); // accepts one whose fd is -1

enum { PICTURE_CACHE_BUCKETS = 4096 };

// Its calls may come from any thread.
struct picture_cache {
    int folder_fd; // owned
    uint64_t limit_bytes;
    pthread_mutex_t lock; // guards what follows
    uint64_t bytes;
    struct cached_picture *buckets[PICTURE_CACHE_BUCKETS];
    struct cached_picture *oldest, *newest; // owned; by their last use
};

// Takes up what the folder holds from before, in the order of its last use, and removes what is over the limit or was
// left half written.
bool picture_cache_open(struct picture_cache *cache, const char *folder, uint64_t limit_bytes, struct error *error);
void picture_cache_close(struct picture_cache *cache);
// True, with the file, if the cache has a whole one for this key.
bool picture_cache_find(struct picture_cache *cache, const char *key, struct picture_file *file);
// Takes the regular file NAME in the folder `from_fd`, which nobody writes any more, into the cache, and opens it. One
// that is larger than the whole cache is opened and not kept.
bool picture_cache_take(struct picture_cache *cache, const char *key, const char *facts, int from_fd, const char *name,
                        struct picture_file *file, struct error *error);
