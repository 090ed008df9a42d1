// What survives: jobs, frames and attempts in SQLite. Blocking; used from one thread at a time.
#pragma once

#include "core/hash.h"
#include "daemon/queue.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct store;

enum store_op_kind {
    STORE_ADD_JOB,
    STORE_SET_JOB,     // priority, flags, times, reason
    STORE_SET_FRAME,   // one frame's row
    STORE_ADD_ATTEMPT, // an attempt ended
    STORE_RESET_FRAMES // delete frame rows of a job by index list: they are queued again (retry)
};

// A frame has a row once it left the queue for good or is being published; a queued or running frame has none, so a
// million queued frames cost a line.
struct store_job {
    int64_t id;
    char *document; // owned; the job file as JSON text
    char *name;     // owned
    char *owner;    // owned; user name
    int64_t owner_uid;
    int priority;
    bool is_paused, is_canceled, is_failed;
    int64_t submitted_ms, started_ms, finished_ms; // unix time; 0: not yet
    char *reason;                                  // owned; NULL: none
    char *root;                                    // owned; output root the job was accepted under
};

struct store_frame {
    int64_t job;
    int32_t index; // in the job's range
    int state;     // enum frame_state; FRAME_RUNNING: a publish intent
    int attempts;
    int64_t epoch;
    uint64_t inode, size_bytes;
    char hash[HASH_TEXT_SIZE];
    double render_s, encode_s;
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

// The op owns what its strings point to once it is in a batch.
struct store_op {
    enum store_op_kind kind;
    union {
        struct store_job job;
        struct store_frame frame;
        struct store_attempt attempt;
        struct {
            int64_t job;
            int32_t *indices; // owned
            size_t count;
        } reset;
    };
};

void store_op_finish(struct store_op *op);

// Opens or makes FOLDER/queue.db (folder made with mode 0700 if missing) and locks it against a second daemon; refuses a
// store a newer version wrote. Adds one to the epoch, durably.
struct store *store_open(const char *folder, struct error *error);
void store_close(struct store *store);
int64_t store_epoch(const struct store *store);
int64_t store_next_job_id(const struct store *store); // one more than any ever given

// All or nothing; on success it is on disk.
bool store_commit(struct store *store, const struct store_op *ops, size_t op_count, struct error *error);

// Called once a row, in order of job id (then index); what they are given is lent for the call. False stops with an error.
typedef bool store_on_job(void *user, const struct store_job *job, struct error *error);
typedef bool store_on_frame(void *user, const struct store_frame *frame, struct error *error);
bool store_load(struct store *store, store_on_job *on_job, store_on_frame *on_frame, void *user, struct error *error);

// For answers: details that the queue does not keep. Any thread, a connection of its own.
struct store_reader;
struct store_reader *store_reader_open(const char *folder, struct error *error);
void store_reader_close(struct store_reader *reader);
// Rows for the frames with index in [first, last]; those without a row are not called.
bool store_read_frames(struct store_reader *reader, int64_t job, int32_t first, int32_t last, store_on_frame *on_frame,
                       void *user, struct error *error);
typedef bool store_on_attempt(void *user, const struct store_attempt *attempt, struct error *error);
// Newest first; frame -1: all.
bool store_read_attempts(struct store_reader *reader, int64_t job, int32_t frame, int limit, store_on_attempt *on_attempt,
                         void *user, struct error *error);
bool store_read_document(struct store_reader *reader, int64_t job, char **document, struct error *error);
