// SPDX-License-Identifier: Apache-2.0
#include "worker/process/plan_mail.h"

#include "core/base/alloc.h"
#include "core/json/json_read.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

void plan_mail_finish(struct plan_mail *mail)
{
    while (mail->letters) {
        struct plan_letter *letter = mail->letters;

        mail->letters = letter->next;
        free(letter->refusal);
        free(letter);
    }
}

struct plan_letter *plan_mail_find(struct plan_mail *mail, const char *key)
{
    struct plan_letter *letter = mail->letters;

    while (letter && strcmp(letter->key, key) != 0)
        letter = letter->next;
    if (letter) return letter;
    letter = xcalloc(1, sizeof *letter);
    memccpy(letter->key, key, 0, sizeof letter->key - 1);
    letter->said = PLAN_SAID_NOTHING;
    letter->frame = -1;
    letter->next = mail->letters;
    mail->letters = letter;
    return letter;
}

// What was told to the worker.
struct told {
    const char *key, *refusal;
    enum plan_said said;
    int64_t number;
    int64_t frame, attempt; // frame -1: told to all workers
};

static bool read_told(struct told *told, const struct json_node *params, struct error *error)
{
    static const char *const words[] = {"plan", "make", "wait", "refuse", NULL};
    struct json_node key = json_node_child(params, "key"), say = json_node_child(params, "say");
    struct json_node number = json_node_child(params, "number"), reason = json_node_child(params, "error");
    struct json_node frame = json_node_child(params, "frame"), attempt = json_node_child(params, "attempt");
    int choice;

    *told = (struct told){.frame = -1};
    if (!json_read_string(&key, &told->key, error) || !json_read_enum(&say, words, &choice, error)) return false;
    told->said = (enum plan_said)choice;
    if (told->said == PLAN_SAID_PLAN && !json_read_integer(&number, 1, INT64_MAX, &told->number, error)) return false;
    if (told->said == PLAN_SAID_REFUSE && !json_read_string(&reason, &told->refusal, error)) return false;
    return json_node_is_absent(&frame) || (json_read_integer(&frame, 0, FRAME_NUMBER_LIMIT - 1, &told->frame, error) &&
                                           json_read_integer(&attempt, 1, INT_MAX, &told->attempt, error));
}

static void note_answer(struct plan_letter *letter, const struct told *told)
{
    if (told->frame != letter->frame || told->attempt != letter->attempt) return;
    letter->said = told->said;
    letter->said_number = told->number;
    free(letter->refusal);
    letter->refusal = told->refusal ? xstrdup(told->refusal) : NULL;
}

bool plan_mail_take(struct plan_mail *mail, const struct json_node *params, const struct job *job, struct error *error)
{
    struct json_node node = json_node_child(params, "plan");
    struct plan_letter *letter;
    struct plan_json plan;
    struct told told;

    if (!read_told(&told, params, error)) return false;
    if (told.said == PLAN_SAID_PLAN && !plan_from_json(&plan, &node, job, error)) return false;
    letter = plan_mail_find(mail, told.key);
    if (told.number > letter->number) {
        letter->number = told.number;
        letter->plan = plan;
    }
    note_answer(letter, &told);
    return true;
}
