// The jobs that the stub worker writes files for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/output_path.h"

#include <stdbool.h>
#include <stdint.h>

#include <sys/stat.h>

struct error;
struct json_node;
struct stub_frame;

struct stub_job {
    int64_t id, epoch;
    char *root, *root_id, *farm_id; // owned; the last two may be NULL
    struct output_path path;        // owned
    bool names_job;                 // the text of a frame's file names the job, too
};

// Reads the message worker.job; false, with a message on standard error, for one that cannot be read.
bool stub_job_read(struct stub_job *job, const struct json_node *params);
void stub_job_finish(struct stub_job *job);
// Writes and syncs the part file of a frame, or, with `is_found`, makes sure that there is a file of its own name. On
// failure `*fault` is the failure's.
bool stub_job_write_file(const struct stub_job *job, const struct stub_frame *frame, bool is_found, struct stat *status,
                         char hash[static HASH_TEXT_SIZE], const char **fault, struct error *error);
// Removes the part file that was written, or cuts it.
void stub_job_spoil_file(const struct stub_job *job, const struct stub_frame *frame, bool is_removed);
