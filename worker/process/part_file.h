// The part file that an attempt writes, and the file that may exist in its place.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct assignment_frame;
struct error;
struct gate_result;

// Opens the folder of the frame's file and checks that it is writable; as output_root_open_folder on failure. The
// folder is never made: whoever sends the job has done it, and a root that is gone must not grow folders.
int part_file_open_folder(const struct assignment_frame *frame, struct error *error);

enum part_file_existing {
    PART_FILE_RENDER, // no file exists, or none that passes the gate
    PART_FILE_SKIP,   // this frame exists and passes the gate, as `found` says
    PART_FILE_REFUSE  // a file exists, and the job refuses existing files, or the job is a draft and the file is none
};
// `picture_hash` is the hash that the file's header must have.
enum part_file_existing part_file_find_existing(const struct assignment_frame *frame, const char *picture_hash,
                                                int folder_fd, struct gate_result *found, struct error *error);

// Whether an earlier daemon left a part file of the frame that passes the gate: it is now this attempt's. False where
// the job was not said to have such files, or the frame is to be rendered in any case. `found` is what the gate read.
bool part_file_take_old(const struct assignment_frame *frame, const char *picture_hash, int folder_fd,
                        struct gate_result *found);

// A new, empty file for reading and writing; -1 on failure, with errno set.
int part_file_create(const struct assignment_frame *frame, int folder_fd, struct error *error);
void part_file_remove(const struct assignment_frame *frame, int folder_fd);
