// The rows of the store, and the operations on them that are committed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/wire/frame_accuracy.h"
#include "daemon/schedule/plan_desk.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

enum { STORE_ATTEMPT_LIMIT = 1000, STORE_PLAN_LIMIT = 1000 };

enum store_op_kind {
    STORE_ADD_JOB,
    STORE_SET_JOB,      // changes the job but its document; name, owner and root stay where they are NULL
    STORE_SET_FRAME,    // writes one frame's row, new or in place of the old one
    STORE_ADD_ATTEMPT,  // adds an ended attempt; only the newest STORE_ATTEMPT_LIMIT of a job are kept
    STORE_RESET_FRAMES, // deletes frame rows of a job by index list: the frames are queued again
    STORE_DELETE_JOB,   // deletes all rows of the job `job.id`, whose id is not used again
    STORE_ADD_PLAN,     // adds a plan; only the newest STORE_PLAN_LIMIT of its owner are kept
    STORE_SET_MARKS,    // writes the marks of all frames of a job, as far as they change
    STORE_SET_ROOT,     // writes the row of an output root, new or in place of the old one
    STORE_SET_USAGE,    // writes what an owner used of the farm, likewise
    STORE_SET_TOKEN,    // writes the row of a token, likewise
    STORE_DELETE_TOKEN, // deletes the row of the token `token.id`, whose id is not used again
    STORE_ADD_NOTICE,
    STORE_DROP_NOTICE, // deletes the notice `notice.id`, if it is there
    STORE_SET_TOLD     // writes that a job told of a cause, or that the cause is over
};

// A frame has a row when it is done or is being published. A queued or running frame has none, so a million queued
// frames take one row, that of their job. In a canceled or failed job the frames without a row are canceled or failed
// too. When a retry queues some frames of the job, marks say that of the others, with two bits a frame, some thousand
// frames a row. Marks also name the queued frames that are to be rendered even if their files are good. A frame's own
// row counts more than its mark, which may be old: each retry writes all marks.
struct store_job {
    int64_t id;
    char *document; // owned; the job file as JSON text
    char *name;     // owned
    char *owner;    // owned; user name
    int64_t owner_uid;
    int priority;
    bool is_paused, is_canceled, is_failed;
    bool waits;                                    // for the jobs that its document names in `after`
    int64_t submitted_ms, started_ms, finished_ms; // unix time; 0: not yet; finished below 0: part files are left
    char *reason;                                  // owned; NULL: none
    char *root;                                    // owned; output root the job was accepted under
    // While the store is loaded: the row, or the document, is not as it was written, and no backup has it.
    bool is_damaged, is_document_damaged;
};

struct store_frame {
    int64_t job;
    int32_t index; // in the job's range
    int state;     // enum frame_state; FRAME_RUNNING: a publish intent
    int attempts;
    int64_t epoch;
    uint64_t inode, size_bytes;
    char hash[HASH_TEXT_SIZE];
    double render_s, encode_s, audit_s;
    struct frame_accuracy accuracy;
    char *error; // owned; NULL: none
};

struct store_attempt {
    int64_t job;
    int32_t frame; // number
    int attempt;
    int worker;
    int64_t ended_ms;
    char outcome[16]; // "failed", "lost", ...
    char *log;        // owned
};

struct store_plan {
    int64_t number; // greater than any before
    struct plan_key key;
    char *text; // owned; the plan as JSON
};

struct store_root {
    char *path; // owned
    char *id;   // owned; of its marker (core/job/root_marker.h)
};

struct store_usage {
    int64_t owner_uid;
    double used_s; // of workers, as the owner's share counts it
    int64_t at_ms; // unix time
};

struct store_token {
    int64_t id;
    char *hash;  // owned; of its text, which the store does not have
    char *name;  // owned
    char *owner; // owned; user name
    int64_t owner_uid;
    char *scope;                             // owned; a word
    int64_t created_ms, expires_ms, used_ms; // unix time; 0: never
    bool is_once;
};

// What a target is to be told.
struct store_notice {
    int64_t id; // greater than any before
    int64_t job;
    int64_t owner_uid; // of the job
    int64_t made_ms;   // unix time
    char *event;       // owned; a name of job_notify_event_names
    char *target;      // owned; a name, or the address of a webhook
    bool is_webhook;
    char *body; // owned; JSON
};

// What a job has told of a cause (daemon/schedule/notice_causes.h).
struct store_told {
    int64_t job;
    int cause;
    int64_t told_ms; // unix time
    bool is_on;      // it has not ended since
};

// An op owns its strings and lists once it is in a batch.
struct store_op {
    enum store_op_kind kind;
    union {
        struct store_job job;
        struct store_frame frame;
        struct store_attempt attempt;
        struct store_plan plan;
        struct store_root root;
        struct store_usage usage;
        struct store_token token;
        struct store_notice notice;
        struct store_told told;
        struct {
            int64_t job;
            int32_t *indices; // owned; fastest when ascending
            size_t count;
        } reset;
        struct {
            int64_t job;
            uint8_t *bytes; // owned; as store_marks_format_op packs them
            size_t size_bytes;
        } marks;
    };
};

struct store_op store_op_reset_frame(int64_t job, int32_t index); // STORE_RESET_FRAMES of one frame
void store_op_finish(struct store_op *op);                        // frees what it owns; accepts the empty zero value

// Called for each row, which is borrowed during the call. False stops the reading with the callback's error.
typedef bool store_on_job(void *user, const struct store_job *job, struct error *error);
typedef bool store_on_frame(void *user, const struct store_frame *frame, struct error *error);
