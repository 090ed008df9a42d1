// Reads and checks the document of a submitted job in a thread.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/error.h"
#include "core/job/input_roots.h"
#include "core/job/job.h"
#include "daemon/loop/work_desk.h"

#include <stdbool.h>
#include <stddef.h>

struct request;

// What is read. The callback may move the answer, and any part of job, paths and document, out of it: what is left is
// freed after the callback.
struct job_document {
    struct work_piece piece;
    void (*on_read)(struct job_document *reading, bool was_read);
    struct farm *farm;     // borrowed; outlives us
    struct client *client; // held
    struct answer *answer; // owned; to be sent by the callback or later
    struct cJSON *request; // owned; what the client sent
    char *root;            // owned; the output root
    bool is_paused;
    bool ok; // else `error` says what is wrong with the document
    struct error error;
    struct job job;
    struct job_paths paths; // owned; the files that the job reads
    char *document;         // owned; the job as JSON text
    size_t length;          // of the document
};

// Takes the root of the request's message. `on_read` is called on the loop; without having read anything when the
// daemon stops. What the client sends next waits until then.
void job_document_read(struct request *request, const char *root, bool is_paused,
                       void (*on_read)(struct job_document *reading, bool was_read));
