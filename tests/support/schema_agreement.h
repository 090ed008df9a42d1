// Checks that jobs/schema.json and the code accept the same documents, except for rules that a schema cannot express.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/error.h"

#include <stdbool.h>
#include <stddef.h>

// Rules that join several keys, or count what JSON Schema does not: the schema accepts what they refuse. `example` is
// an edit of job_text_full that breaks the rule (path NULL: the rule is for a time), `message` a part of the resulting
// message.
struct cross_rule {
    const char *name, *message;
    struct {
        const char *path, *value;
    } example;
};

extern const struct cross_rule schema_cross_rules[]; // ends with an empty one

struct schema_verdicts {
    bool schema, code;
    struct error error; // the code's
};

// cmocka's group setup and teardown: they load and free the schema.
int schema_agreement_load(void **state);
int schema_agreement_drop(void **state);

struct schema_verdicts schema_agreement_judge(const char *text);
// The rule that a message of the code belongs to, or NULL.
const struct cross_rule *schema_agreement_find_rule(const char *message);
// Fails the test unless schema and code agree on `text`, or a rule explains the difference. `change` is for the
// message.
void schema_agreement_assert(const char *text, const char *change);
// Removes, renames and replaces each value of `text` whose path begins with `prefix`, one at a time; both must agree on
// each.
void schema_agreement_check_places(const char *text, const char *prefix);
