// What a fenced worker may reach: the files of the job that it is started for, and of its owner's next jobs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/input_roots.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct farm;
struct job_fence;
struct job_record;
struct json_writer;

// The files that a job reads. The zero value is empty.
struct job_fence_files {
    int64_t job;              // 0: none
    struct job_inputs inputs; // owned
    bool is_found;            // false: the job reads files below no root
    bool has_converter;
};

void job_fence_files_finish(struct job_fence_files *files);

// The fence of the job and of the jobs of the same owner that come after it in the queue, as many as are read soon
// enough. A job that runs the converter, or into whose folder another owner's jobs write, is alone in its fence. NULL
// when the job reads a file below no input root: a fault of the job.
struct job_fence *job_fence_create(const struct farm *farm, const struct job_record *record, struct error *error);
void job_fence_destroy(struct job_fence *fence); // accepts NULL
// The message worker.fence.
void job_fence_write(const struct job_fence *fence, const struct farm *farm, struct json_writer *writer);
// To be told of each new job: if it is another owner's and writes into a folder of the fence, the fence is shared from
// now on. Returns whether it is.
bool job_fence_note_job(struct job_fence *fence, const struct job_record *record);
// Whether jobs of other owners write into a folder of the fence. The worker then serves its first job alone.
bool job_fence_is_shared(const struct job_fence *fence);
// Whether an output root of the fence was found in another place since: to the kernel its folders are others.
bool job_fence_is_old(const struct job_fence *fence);
// Whether a worker inside this fence may be given the job: the fence is not shared, the job is the same owner's, it
// runs no converter, and its files lie, by their paths, where the fence opens. The kernel may still refuse one: a
// folder made anew is another one to it. `files` has what was read of the latest job that was asked about, for the next
// fence.
bool job_fence_opens(const struct job_fence *fence, const struct farm *farm, const struct job_record *record,
                     struct job_fence_files *files);
