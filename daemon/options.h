// How marchd is started: the command line over the environment over a file over defaults.
#pragma once

#include "core/log.h"

#include <stdbool.h>
#include <stdint.h>

struct error;

// What the defaults depend on. Borrowed; strings may be NULL.
struct options_surroundings {
    const char *home, *xdg_state_home, *xdg_runtime_dir, *marchd_socket; // environment variables
    const char *config_path;    // a file that is read if it is there and none is named
    const char *current_folder; // absolute; relative paths are taken from there
    const char *program_folder; // absolute; where march-worker is looked for
    bool is_root;
};

// The zero value is empty. Strings are owned and paths absolute.
struct options {
    char *state_folder;
    char *socket_path;
    char *output_root;
    char *worker_program;
    char *shader_folder; // NULL: the worker's own shaders
    char *backend;       // "auto", "egl" or "osmesa"
    int worker_count;    // 0: as many as there are cores
    int thread_count;    // that one worker renders with
    int max_attempts;
    int64_t stop_timeout_ms;
    int64_t progress_limit_ms; // a worker without progress is killed after it
    enum log_level log_level;
    bool wants_help, wants_version; // then nothing else is filled
};

bool options_parse(struct options *options, int argc, char **argv, const struct options_surroundings *surroundings,
                   struct error *error);
void options_finish(struct options *options); // accepts the empty value
extern const char options_help[];
