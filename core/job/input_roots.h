// The files that a job reads, the root that each must stay below, and how such a folder is opened.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct job;
struct path_list;

enum { INPUT_PLACE_SIZE = 80 };

struct job_input {
    char *path;                   // owned; of a sequence, its name has the run of `#`
    char *root;                   // owned; as the list has it
    char *folder;                 // owned; of the file, relative to the root; "" for the root itself
    char place[INPUT_PLACE_SIZE]; // in the document: "scene.media[0].density.file"
};

// The zero value is empty.
struct job_inputs {
    struct job_input *inputs; // owned; grids and textures, in the scene's order
    size_t count, capacity;
};

// By the texts alone: an absolute path without "." or ".." or a slash too many, below one of the roots. On failure
// `inputs` is empty, and the message names the place, the path and the roots.
bool input_roots_find(struct job_inputs *inputs, const struct job *job, const struct path_list *roots,
                      struct error *error);
void job_inputs_finish(struct job_inputs *inputs); // accepts the empty value

// Opens a folder below `root` (which itself may be reached through links) so that nothing on the way leaves it: a link
// inside is followed when it is relative and stays below the root. Returns an O_PATH descriptor, or -1 with errno and the cause.
int input_roots_open_folder(const char *root, const char *folder, struct error *error);
// That, and where the file is there, that it is one and no link out of the root. The message names the place.
// Returns 0, or an errno value: EXDEV and ELOOP where a link leads astray.
int input_roots_check_opening(const struct job_input *input, struct error *error);
