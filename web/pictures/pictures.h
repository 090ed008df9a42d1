// Pictures of frames and explanations of jobs for browsers, by a few threads: the program's loop waits for nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "web/pictures/picture_cache.h"
#include "web/pictures/picture_status.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct path_list;
struct picture_ask;
struct picture_query;
struct pictures;

enum { PICTURE_MAKER_LIMIT = 4 };

struct pictures_params {
    const char *worker;       // the program; borrowed for the call, like the next one
    const char *cache_folder; // absolute; it is there
    uint64_t cache_bytes;
    int64_t worker_bytes; // memory of a worker
    int limit_ms;         // a picture's time
    int maker_count;      // so many are made at a time, up to PICTURE_MAKER_LIMIT
    // Called by another thread when there are answers to take; it returns at once.
    void (*on_answers)(void *user);
    void *user;
};

struct picture_question {
    const struct picture_query *query; // borrowed for the call, as all that follows
    const char *subject;               // the frame's file, or the document of the job to be explained
    const struct path_list *roots;     // below which the file is, or those that the job reads
    int64_t user;                      // who asks: users take turns
    const char *known;                 // the value of If-None-Match; NULL: none
};

struct picture_answer {
    enum picture_status status;
    const char *reason;        // why there is none; NULL: there is one
    char key[HASH_TEXT_SIZE];  // another one for another picture; empty: the file was not found
    struct picture_file *file; // PICTURE_READY alone; whoever takes its descriptor sets -1 in its place
};

// Starts the threads.
struct pictures *pictures_create(const struct pictures_params *params, struct error *error);
// Ends workers; who still waits is forgotten. What hangs on a disk is left to itself.
void pictures_destroy(struct pictures *pictures);

// Asks for a picture; the answer comes later, whatever it is, unless the question is dropped. `user` comes with it.
struct picture_ask *pictures_ask(struct pictures *pictures, const struct picture_question *question, void *user);
// Nobody waits any more. A picture that is not begun is not made.
void pictures_drop(struct pictures *pictures, struct picture_ask *ask);
// Called twice a second or so, as long as files are looked at (true): who has waited for a disk that does not answer
// gets PICTURE_SLOW.
bool pictures_expire(struct pictures *pictures);
// An answer that has come; NULL: there is none. The caller frees it.
struct picture_ask *pictures_take_answer(struct pictures *pictures);
struct picture_answer picture_ask_answer(struct picture_ask *ask); // what it points to lives as long as the ask
void *picture_ask_user(const struct picture_ask *ask);
void picture_ask_free(struct picture_ask *ask);
