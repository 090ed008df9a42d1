// How marchd is started: the command line over the environment over a file over defaults.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.h"
#include "core/base/path_list.h"

#include <stdbool.h>
#include <stdint.h>

struct error;

// What the defaults depend on. Borrowed; strings may be NULL.
struct options_surroundings {
    const char *home, *xdg_state_home, *xdg_runtime_dir, *marchd_socket; // environment variables
    const char *config_path;    // the system's file: read for root and with --system, if it is there and none is named
    const char *current_folder; // absolute; relative paths are taken from there
    const char *program_folder; // absolute; where march-worker is looked for
    bool is_root;
};

// The zero value is empty. Strings are owned and paths absolute.
struct options {
    char *state_folder;
    char *socket_path;
    struct path_list output_roots; // at least one: where relative paths go
    struct path_list input_roots;  // at least one
    char *worker_program;
    char *shader_folder; // NULL: the worker's own shaders
    char *backend;       // "auto", "egl" or "osmesa"
    char *admin_group;   // a group's name
    int worker_count;    // 0: as many as there are cores
    int thread_count;    // that one worker renders with
    int max_attempts;
    int64_t stop_timeout_ms;
    int64_t progress_limit_ms; // a worker without progress is killed after it
    // What a user may have at a time; 0: any number.
    int64_t user_jobs;           // that are not over
    int64_t user_frames;         // of those jobs, not done yet
    int64_t user_pixels;         // of those frames
    int64_t user_disk_bytes;     // of the files published for jobs that are still known
    int64_t worker_memory_bytes; // that one worker may allocate; 0: its share of the machine's, -1: any amount
    bool has_sandbox;            // workers fence themselves in
    enum log_level log_level;
    bool wants_help, wants_version; // then nothing else is filled
};

bool options_parse(struct options *options, int argc, char **argv, const struct options_surroundings *surroundings,
                   struct error *error);
void options_finish(struct options *options); // accepts the empty value
extern const char options_help[];
