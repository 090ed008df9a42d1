// The record of each job: everything but the states of its frames, which the queue holds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.h"
#include "core/job/frame_set.h"
#include "core/job/input_roots.h"
#include "core/job/job.h"
#include "core/job/job_after.h"
#include "core/job/job_notes.h"
#include "core/job/job_notify.h"
#include "core/job/output_path.h"
#include "core/wire/frame_accuracy.h"
#include "daemon/farm/root_table.h"
#include "daemon/schedule/estimate.h"
#include "daemon/schedule/notice_causes.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/store_op.h"
#include "daemon/users/quota.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// What of the document the daemon needs at hand. The zero value: it cannot be read.
struct job_facts {
    bool is_draft;             // its quality is draft
    enum job_method method;    // that it states; auto: the planner chooses
    int64_t frame_pixels;      // pixels of one frame
    char hash[HASH_TEXT_SIZE]; // of its pictures
    double tolerance;          // of a frame's measured error; 0: none
    int64_t frame_limit_ms;    // time of an attempt at a frame; 0: the farm's
};

struct job_facts job_facts_of(const struct job *job);

// Of the frame of a job that was done last and whose accuracy is known; 0 and empty: none.
struct job_accuracy {
    double error, error95;
    char method[FRAME_ACCURACY_TEXT_SIZE];
};

// A record lives until it is removed from the table and nobody holds it. Threads may read what never changes: id, root,
// path, and path and id of the output root.
struct job_record {
    int64_t id;
    struct queue_job *queued; // borrowed from the queue
    char *name, *owner;       // owned
    struct job_notes notes;
    struct job_notify notify;
    struct job_after after; // the jobs that it comes after
    int64_t *waiters;       // owned; ids of jobs that come after it; some may be gone
    size_t waiter_count, waiter_capacity;
    int64_t owner_uid;
    char *root;                                    // owned; output root below which it was accepted
    struct root *output_root;                      // borrowed from the farm; `root` is its path
    struct output_path path;                       // owned
    int64_t submitted_ms, started_ms, finished_ms; // unix time; 0: not yet
    int64_t served_ms;                             // unix time; when a frame of it ran last; 0: not since the start
    bool is_served;                                // a frame of it ran when served_ms was noted
    char *reason;                                  // owned; why it is paused or failed; NULL: none
    struct job_paths inputs;                       // owned; the files that it reads
    char *pool;                                    // owned; name or tag of its pools; NULL: any
    char *code;                                    // owned; the name of GLSL by the user that it runs; NULL: none
    struct job_facts facts;                        // of its document
    bool has_old_parts;                            // it is from before this start: part files may be left of it
    int64_t disk_bytes;                            // size of its published files
    struct quota_user *user;                       // borrowed from the quota; the owner
    struct quota_amounts share;                    // its share of what the owner has
    struct estimate estimate;
    struct job_accuracy latest;
    struct store_frame *intents; // owned; of queued frames: published or not, says the root when it is back
    size_t intent_count, intent_capacity;
    struct notice_told told[NOTICE_CAUSE_COUNT]; // by enum notice_cause
    bool is_end_told;                            // the notice of its end is stored, as far as somebody wants it
    int told_waiters;                            // its state when they were looked at last
    int frames_in_flight;                        // frames that workers hold or that are being published
    int failed_starts;                           // consecutive workers for it that ended before they were ready
    bool is_last_start;                      // workers for other jobs do start: one more failed start pauses the job
    int root_doubts;                         // faults of a root that was there all the same, since the latest frame
    bool is_output_checked;                  // a check of its output is under way
    bool needs_sweep;                        // part files may be left: of a root that was away, of a lost node
    bool needs_own_worker;                   // a frame of it failed in a worker that was started for another job
    int holds;                               // users that keep it alive after its removal
    bool waits;                              // for those that it comes after
    bool is_unreadable;                      // its document cannot be read: it is shown, and can be deleted
    bool is_removed;                         // from the table
    bool is_deleting;                        // a deletion is under way
    bool is_retry_waiting;                   // a retry has begun, or waits until it is swept
    bool is_retrying;                        // a retry has begun: others wait
    bool is_ending;                          // it is over, and no frame of it is in flight
    bool is_sweeping;                        // its part files are being removed
    bool is_swept;                           // they are removed: finished_ms may be stored
    enum job_state sent_state;               // the state in the last event
    bool is_changed;                         // its counts changed since the last event
    bool restored_canceled, restored_failed; // while the store is loaded: the flags of its row
};

// Records by ascending id. The zero value is empty.
struct job_table {
    struct job_record **records; // owned
    uint64_t *folder_hashes;     // owned; a hash of the folder of each record, for fast searches
    size_t count, capacity, hash_capacity;
};

void job_table_finish(struct job_table *table);
// `id` must be greater than any before. `root` (owned) and `path` move into the record.
struct job_record *job_table_add(struct job_table *table, int64_t id, char *root, struct output_path *path);
void job_table_remove(struct job_table *table, struct job_record *record);    // it is freed when nobody holds it
struct job_record *job_table_find(const struct job_table *table, int64_t id); // NULL: none
size_t job_table_first_from(const struct job_table *table, int64_t id); // the index of the first whose id is not less

struct log_subject job_record_subject(const struct job_record *record); // job and owner; valid while the record lives
void job_record_hold(struct job_record *record);
void job_record_release(struct job_record *record);

void job_record_set_reason(struct job_record *record, const char *reason); // copies; NULL: none
void job_record_note_accuracy(struct job_record *record, const struct frame_accuracy *accuracy);
// Copies the row of a publish intent whose outcome is not known; its frame is queued.
void job_record_keep_intent(struct job_record *record, const struct store_frame *row);
// An op that stores the part of the job that may change.
struct store_op job_record_format_op(const struct job_record *record);

// The files a job writes. Borrowed.
struct job_files {
    const char *root;
    const struct output_path *path;
    const struct frame_range *frames;
    // A set for the frames, empty at first (core/job/frame_twins.h). NULL: each comparison makes its own.
    struct frame_set *marks; // borrowed
};

struct job_files job_record_files(const struct job_record *record);
// True when both write one file; `*frame` is its frame in `files`.
bool job_files_collide(const struct job_files *files, const struct job_files *others, int32_t *frame);
// The first job of another user with published files that collides with `files`; NULL: none.
struct job_record *job_table_find_owned_files(const struct job_table *table, const struct job_files *files,
                                              int64_t owner_uid, int32_t *frame);
// The first other job that collides with `files` and will write or remove them: it is live, is being deleted, or has a
// retry that waits. NULL: none.
struct job_record *job_table_find_collision(const struct job_table *table, const struct job_files *files,
                                            int32_t *frame);
// The first other job that collides with `files` and is over but for frames in flight, which will soon end. NULL: none.
struct job_record *job_table_find_ending(const struct job_table *table, const struct job_files *files, int32_t *frame);
// The next job at or after `*index`, 0 at first, that writes into the folder of `files`; NULL at the end.
struct job_record *job_table_next_neighbour(const struct job_table *table, const struct job_files *files,
                                            size_t *index);
