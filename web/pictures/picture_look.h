// A look at the files of a question: which picture, or which explanation, of which version of them is asked for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/error.h"
#include "core/base/hash.h"
#include "core/base/path_list.h"
#include "web/pictures/explanation.h"
#include "web/pictures/picture_lanes.h"
#include "web/pictures/picture_place.h"
#include "web/pictures/picture_query.h"
#include "web/pictures/picture_status.h"

struct picture_ask;
struct picture_check;

// It has copies of all that it needs: who asked may be gone when a disk answers.
struct picture_look {
    struct lane_task task; // the first member
    struct picture_query query;
    char *subject;          // owned, as all that follows; the frame's file, or the document
    char *worker;           // the program
    struct path_list roots; // of files
    // What was found:
    enum picture_status status; // PICTURE_READY: so far all is well
    struct error error;
    char key[HASH_TEXT_SIZE]; // empty: none
    struct picture_place place;
    struct explanation_key explanation;
    // Who waits for it, both borrowed and under their lock; NULL: nobody.
    struct picture_ask *ask;
    struct picture_check *check;
};

// Copies what it is given.
struct picture_look *picture_look_create(const struct picture_query *query, const char *subject, const char *worker,
                                         const struct path_list *roots);
struct picture_look *picture_look_copy(const struct picture_look *look); // of what was asked, and what was found
void picture_look_free(struct picture_look *look);                       // accepts NULL
struct picture_look *picture_look_of(struct lane_task *task);

// The root whose disk has to be asked next, or "" where none is needed yet; NULL: all is found.
const char *picture_look_lane(const struct picture_look *look);
void picture_look_run(struct lane_task *task); // takes this step; it may wait for the disk as long as the disk likes
