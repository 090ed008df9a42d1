// Finds the input root of each file that a job reads, and opens folders below roots.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct job;
struct path_list;

enum { INPUT_PLACE_SIZE = 80 };

struct job_input {
    char *path;                   // owned; the name of a sequence has a run of `#`
    char *root;                   // owned; as in the list of roots
    char *folder;                 // owned; the file's, relative to the root; "" for the root itself
    char place[INPUT_PLACE_SIZE]; // in the document: "scene.media[0].density.file"
};

// A file that a job reads, wherever it lies.
struct job_path {
    char *path;                   // owned
    char place[INPUT_PLACE_SIZE]; // as in struct job_input
};

// The zero value is empty.
struct job_paths {
    struct job_path *paths; // owned; grids and textures, in the scene's order
    size_t count, capacity;
};

void job_paths_list(struct job_paths *paths, const struct job *job);
void job_paths_finish(struct job_paths *paths); // accepts the empty value

// The zero value is empty.
struct job_inputs {
    struct job_input *inputs; // owned; grids and textures, in the scene's order
    size_t count, capacity;
};

// Compares texts only: a path must be absolute, without ".", ".." or doubled slashes, and below one of the roots. On
// failure `inputs` is empty, and the message names the place, the path and the roots.
bool input_roots_find(struct job_inputs *inputs, const struct job_paths *paths, const struct path_list *roots,
                      struct error *error);
// True when a worker runs a program of OpenVDB's to read one of them.
bool job_inputs_need_converter(const struct job_inputs *inputs);
void job_inputs_finish(struct job_inputs *inputs); // accepts the empty value

// Opens a folder below `root` (which itself may be reached through links) and never leaves the root: a link inside is
// followed when it is relative and stays below the root. Returns an O_PATH descriptor, or -1 with errno and `error`
// set.
int input_roots_open_folder(const char *root, const char *folder, struct error *error);
// Checks that the folder of `input` can be opened, and that its file, if it exists, is no link out of the root. The
// message names the place. Returns 0, or an errno value: EXDEV or ELOOP where a link leads out or in a loop.
int input_roots_check_opening(const struct job_input *input, struct error *error);
