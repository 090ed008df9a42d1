// The state that the daemon's modules share: jobs, their queue, and the modules that act on them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/farm/job_table.h"
#include "daemon/farm/notice_targets.h"
#include "daemon/farm/root_table.h"
#include "daemon/schedule/notice_list.h"
#include "daemon/schedule/plan_desk.h"
#include "daemon/users/quota.h"
#include "daemon/users/rights.h"
#include "daemon/users/token_table.h"

#include <stdbool.h>
#include <stdint.h>

#include <uv.h>

struct after_desk;
struct committer;
struct error;
struct events;
struct loop_turns;
struct memory_return;
struct metrics;
struct options;
struct publisher;
struct reload_changes;
struct root_desks;
struct store_reader;
struct sweeper;
struct work_desk;
struct worker_pool;

// Nothing new is begun while `user` asks for it.
struct farm_drain {
    char *user;       // owned; NULL: nobody
    int64_t since_ms; // unix time
};

// Reads the settings again and applies them, or fails and changes nothing; `asked_by` names the client.
typedef bool farm_reload(void *user, const char *asked_by, struct reload_changes *changes, struct error *error);

// All pointers are borrowed from the daemon, which connects the modules.
struct farm {
    uv_loop_t *loop;
    struct loop_turns *turns;
    struct metrics *metrics;
    struct work_desk *work;        // what requests do off the loop
    struct root_desks *root_desks; // what jobs do in output roots, likewise
    struct memory_return *memory;
    const struct options *options;
    struct store_reader *reader; // for small reads on the loop
    struct queue *queue;
    struct job_table jobs;        // owned
    struct root_table roots;      // owned
    char id[ROOT_MARKER_ID_SIZE]; // of the farm; it never changes
    struct quota quota;           // owned; what each user has
    struct committer *committer;
    struct publisher *publisher;
    struct publisher *checker; // looks at files that workers found, which takes longer
    struct sweeper *sweeper;
    struct worker_pool *pool;
    struct events *events;
    struct output_claim *claims;        // list: files of jobs being submitted or deleted
    struct after_desk *after;           // jobs that come after others
    struct job_delete *deletions;       // list: deletions that are not done
    struct job_submit *waiting_submits; // list: submissions that wait until canceled jobs have left their files
    struct job_retry *waiting_retries;  // list: retries that wait until their job is swept, or for another
    struct late_sweep *late_sweeps;     // list: jobs that lost nodes may still write for
    int output_checks;                  // jobs whose output is being checked
    int64_t epoch;
    int64_t next_job_id;
    int64_t next_plan_number;
    int64_t started_ms;       // unix time
    int64_t shares_stored_ms; // monotonic; when the owners' use was stored last
    struct rights rights;
    struct token_table tokens;     // owned
    int64_t wrong_tokens_told_ms;  // monotonic; when the log was told of a wrong token last
    int64_t wrong_tokens_untold;   // since then
    struct plan_desk desk;         // owned; the plans that are being made
    struct farm_drain drain;       // owned
    struct notice_list notices;    // owned; those that wait for delivery
    struct notice_targets targets; // owned; whom march-web can tell
    int64_t next_notice_id;
    farm_reload *reload;
    void *reload_user;
    bool wants_feed; // a worker may take frames: they are assigned at the end of the iteration
};

int64_t farm_now_ms(const struct farm *farm); // monotonic
int64_t farm_clock_ms(void);                  // unix time
void farm_want_feed(struct farm *farm);
char *farm_format_drain(const struct farm *farm); // why nothing new is begun; NULL: nobody asked. Owned by the caller

// Stores the op, with tries until it is on disk.
void farm_store(struct farm *farm, struct store_op op);
// Stores the part of the job that may change.
void farm_store_job(struct farm *farm, const struct job_record *record);
