// What a worker is asked for the explanation of a job: its document, and which files the worker may open for it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "web/pictures/picture_status.h"

#include <stdbool.h>

struct error;
struct json_writer;
struct path_list;

enum { EXPLANATION_DOCUMENT_LIMIT = 256 * 1024 }; // bytes: many may wait

struct explanation {
    const char *document;          // JSON text; borrowed, like the others
    const char *worker;            // the program that explains
    const struct path_list *roots; // the farm's input roots
};

// Another key for another document, another version of a file that its first frame reads, or another worker.
// PICTURE_READY, or why there can be no explanation: the document is no job, or names a file below no input root.
enum picture_status explanation_make_key(const struct explanation *explanation, char key[static HASH_TEXT_SIZE],
                                         struct error *error);
// Writes worker.fence and worker.explain. The fence has the folders of the job's files, as that of a farm's worker, and
// `folder`, the maker's own; what lies beside that folder is closed.
bool explanation_write(const struct explanation *explanation, const char *folder, struct json_writer *writer,
                       struct error *error);
