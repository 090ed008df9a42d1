// The file an attempt writes, and the one that may be there before it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct assignment_frame;
struct error;
struct gate_result;

// The folder of the frame's file, made if it is missing and known to be writable; -1 on failure.
int part_file_open_folder(const struct assignment_frame *frame, struct error *error);

enum part_file_existing {
    PART_FILE_RENDER, // nothing is there, or nothing that counts
    PART_FILE_SKIP,   // this very frame is there, described in `found`
    PART_FILE_REFUSE  // the job wants no file to be there, and one is
};
// `picture_hash` is what the file's header has to say.
enum part_file_existing part_file_find_existing(const struct assignment_frame *frame, const char *picture_hash,
                                                int folder_fd, struct gate_result *found, struct error *error);

// A new, empty file for reading and writing; -1 on failure, with errno set.
int part_file_create(const struct assignment_frame *frame, int folder_fd, struct error *error);
void part_file_remove(const struct assignment_frame *frame, int folder_fd);
