// What users note of a job for themselves: a comment and tags. No picture depends on them, and no hash has them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct json_node;
struct json_writer;

enum {
    JOB_COMMENT_LIMIT = 1000, // bytes
    JOB_TAG_LIMIT = 16,
    JOB_TAG_SIZE_LIMIT = 64 // bytes of a tag
};

// The zero value is empty.
struct job_notes {
    char *comment;             // owned; NULL: none
    char *tags[JOB_TAG_LIMIT]; // owned
    size_t tag_count;
};

// Reads the job's `comment` and `tags`, which may be absent. Finish in both cases.
bool job_notes_from_json(struct job_notes *notes, const struct json_node *document, struct error *error);
void job_notes_finish(struct job_notes *notes); // accepts empty notes
// Writes the members `comment` (null without one) and `tags` (an array) into an object.
void job_notes_write_members(const struct job_notes *notes, struct json_writer *writer);
// The tags in one line, separated by ", "; owned by the caller, NULL when there are none.
char *job_notes_format_tags(const struct job_notes *notes);
// True without control characters: bytes below 0x20, DEL, and U+0080 to U+009F in UTF-8.
bool job_notes_is_printable(const char *text);
