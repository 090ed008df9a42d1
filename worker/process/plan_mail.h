// What the worker was told of a job's plans: the newest of each segment, and the answer to its latest question.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/plan_json.h"

#include <stdint.h>

struct error;
struct json_node;

enum plan_said {
    PLAN_SAID_PLAN, // the plan is there, or was numbered
    PLAN_SAID_MAKE,
    PLAN_SAID_WAIT, // another worker makes it
    PLAN_SAID_REFUSE,
    PLAN_SAID_NOTHING
};

struct plan_letter {
    char key[HASH_TEXT_SIZE];
    int64_t number; // of the newest plan; 0: none
    struct plan_json plan;
    // The question, by the frame that asked it, and the answer.
    int32_t frame;
    int attempt;
    enum plan_said said;
    int64_t said_number;      // PLAN_SAID_PLAN: of the plan that was asked for, or that was sent
    char *refusal;            // owned; PLAN_SAID_REFUSE: why
    struct plan_letter *next; // in the mail
};

// The zero value is empty.
struct plan_mail {
    struct plan_letter *letters; // owned
};

void plan_mail_finish(struct plan_mail *mail);
// The letter of the key; made if there is none.
struct plan_letter *plan_mail_find(struct plan_mail *mail, const char *key);
// Takes the params of worker.plan. The answer to an older question is dropped; a plan is kept if it is the newest.
bool plan_mail_take(struct plan_mail *mail, const struct json_node *params, const struct job *job, struct error *error);
