// Asks the program that handed out a frame for the plan of its segment, and sends it plans that were made here.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "worker/plan/plan_source.h"

struct assignment_frame;
struct worker;

struct plan_post {
    struct worker *worker;                // borrowed
    const struct assignment_frame *frame; // borrowed
    void (*on_wait)(void *user);          // called when another worker makes the plan
    void *user;
};

// `post` outlives the source. For the rendering thread, which waits for answers.
struct plan_source plan_post_open(struct plan_post *post);
