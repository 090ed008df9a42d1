// What the daemon knows of each job beside the states of its frames.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.h"
#include "core/job/output_path.h"
#include "daemon/schedule/estimate.h"
#include "daemon/schedule/queue.h"
#include "daemon/store/store_op.h"
#include "daemon/users/quota.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Lives until it is deleted and nobody holds it, so that threads may read what never changes: id, root and path.
struct job_record {
    int64_t id;
    struct queue_job *queued; // borrowed from the queue
    char *name, *owner;       // owned
    int64_t owner_uid;
    char *root;                                    // owned; output root it was accepted under
    struct output_path path;                       // owned
    int64_t submitted_ms, started_ms, finished_ms; // unix time; 0: not yet
    char *reason;                                  // owned; why it is paused or failed; NULL: none
    char *code;                                    // owned; the name of a text by the user that it runs; NULL: none
    int64_t frame_pixels;                          // of one picture
    int64_t disk_bytes;                            // of its files, as they were published
    struct quota_user *user;                       // borrowed from the quota; the owner
    struct quota_amounts share;                    // what is counted of it
    struct estimate estimate;
    int frames_in_flight;                    // frames that workers hold or that are being published
    int failed_starts;                       // of its workers, in a row, that ended before they were ready
    bool is_last_start;                      // others do start: the next of its own that does not is the last
    int holds;                               // of those who outlive it on the table
    bool is_removed;                         // from the table
    bool is_deleting;                        // it will be forgotten
    bool is_retry_waiting;                   // it lives again once it is swept
    bool is_ending;                          // it ended, and nobody holds a frame of it
    bool is_sweeping;                        // its leftovers are being removed
    bool is_swept;                           // they are: finished_ms may be written
    enum job_state sent_state;               // what subscribers were told last
    bool is_changed;                         // its counts changed since
    bool restored_canceled, restored_failed; // while a store is loaded: what its row says
};

// The zero value is empty. Ascending by id.
struct job_table {
    struct job_record **records; // owned
    uint64_t *folder_hashes;     // owned; of where each writes, so that few records are looked at among many
    size_t count, capacity, hash_capacity;
};

void job_table_finish(struct job_table *table);
// An id greater than any before; `root` (owned) and `path` move in.
struct job_record *job_table_add(struct job_table *table, int64_t id, char *root, struct output_path *path);
void job_table_remove(struct job_table *table, struct job_record *record);    // freed when nobody holds it
struct job_record *job_table_find(const struct job_table *table, int64_t id); // NULL: there is none

struct log_subject job_record_subject(const struct job_record *record); // job and owner; good as long as the record
void job_record_hold(struct job_record *record);
void job_record_release(struct job_record *record);

void job_record_set_reason(struct job_record *record, const char *reason); // copies; NULL: none
// An op that stores what may change of the job.
struct store_op job_record_format_op(const struct job_record *record);

// The files a job writes. Borrowed.
struct job_files {
    const char *root;
    const struct output_path *path;
    const struct frame_range *frames;
};

struct job_files job_record_files(const struct job_record *record);
// True when they have a file in common; `*frame` is its frame in `files`.
bool job_files_collide(const struct job_files *files, const struct job_files *others, int32_t *frame);
// The first job of another user that has files and collides with `files`; NULL: none.
struct job_record *job_table_find_owned_files(const struct job_table *table, const struct job_files *files,
                                              int64_t owner_uid, int32_t *frame);
// The first other job that is live or about to be, whose frames are still in hand or that is being deleted, and collides with `files`; NULL:
// none.
struct job_record *job_table_find_collision(const struct job_table *table, const struct job_files *files,
                                            int32_t *frame);
