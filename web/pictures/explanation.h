// What a worker is asked for the explanation of a job: its document, and which files the worker may open for it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "core/job/input_roots.h"
#include "core/json/json_write.h"
#include "web/pictures/picture_status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;
struct path_list;

enum { EXPLANATION_DOCUMENT_LIMIT = 256 * 1024 }; // bytes: many may wait

struct explanation {
    const char *document;          // JSON text; borrowed, like the others
    const char *worker;            // the program that explains
    const struct path_list *roots; // the farm's input roots
};

// A key that is being made, root by root: the disk of one may not answer. The zero value is empty.
struct explanation_key {
    struct job_inputs inputs;  // owned; in the scene's order
    size_t next;               // the first of them that was not looked at
    int32_t first_frame;       // it is what is explained of a sequence
    struct json_writer writer; // owned; what the key is the hash of
};

// PICTURE_READY, or why there can be no explanation: the document is no job, or names a file below no input root. No
// input is looked at.
enum picture_status explanation_key_begin(struct explanation_key *key, const struct explanation *explanation,
                                          struct error *error);
const char *explanation_key_root(const struct explanation_key *key); // where to look next; NULL: all was looked at
// Looks which version of the next files is there, as far as they are below one root, and of what their headers name.
void explanation_key_look(struct explanation_key *key);
// Another key for another document, another version of a file that its first frame reads, or another worker.
void explanation_key_make(const struct explanation_key *key, char text[static HASH_TEXT_SIZE]);
void explanation_key_finish(struct explanation_key *key); // accepts the empty value

// Writes worker.fence and worker.explain. The fence has the folders of the job's files, as that of a farm's worker, and
// `folder`, the maker's own; what lies beside that folder is closed.
bool explanation_write(const struct explanation *explanation, const char *folder, struct json_writer *writer,
                       struct error *error);
