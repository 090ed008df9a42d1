// Whom a job tells what becomes of it: targets of the farm by name, or an address of the web.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct json_node;

enum {
    JOB_NOTIFY_LIMIT = 8,           // rules of a job
    JOB_NOTIFY_NAME_LIMIT = 64,     // bytes of a target's name
    JOB_NOTIFY_WEBHOOK_LIMIT = 1000 // bytes of an address
};

enum job_notify_event {
    JOB_NOTIFY_DONE,    // all frames are there
    JOB_NOTIFY_FAILED,  // it is over, and frames failed
    JOB_NOTIFY_WAITING, // it waits for something else than its turn
    JOB_NOTIFY_MISSED   // a frame was published over the tolerance
};
enum { JOB_NOTIFY_EVENT_COUNT = JOB_NOTIFY_MISSED + 1 };

extern const char *const job_notify_event_names[]; // by enum job_notify_event; ends in NULL

// Exactly one of `to` and `webhook` is set.
struct job_notify_rule {
    unsigned on;   // bits 1 << enum job_notify_event; at least one
    char *to;      // owned; a target's name
    char *webhook; // owned; an http or https address
};

// The zero value is empty.
struct job_notify {
    struct job_notify_rule rules[JOB_NOTIFY_LIMIT];
    size_t count;
};

// Reads the job's `notify`, which may be absent. Finish in both cases.
bool job_notify_from_json(struct job_notify *notify, const struct json_node *document, struct error *error);
void job_notify_finish(struct job_notify *notify); // accepts an empty one
// Reads "NAME:EVENT,EVENT" as one more rule, as settings have it.
bool job_notify_parse(struct job_notify *notify, const char *text, struct error *error);
bool job_notify_is_name(const char *text); // of a target
// True for an http or https address of printable ASCII whose host is a name or an IPv4 address, without a user.
bool job_notify_is_webhook(const char *text);
