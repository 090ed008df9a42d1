// Options of marchd, from the command line, the environment, a file and defaults, in that order of precedence.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.h"
#include "core/base/path_list.h"
#include "core/job/job_notify.h"
#include "daemon/settings/pool_options.h"
#include "daemon/settings/user_weights.h"

#include <stdbool.h>
#include <stdint.h>

struct error;

#define OPTIONS_ADMIN_GROUP "marchd-admin" // unless a setting names another
#define OPTIONS_WEB_USER "marchd-web"      // likewise

// The surroundings that the defaults depend on. Borrowed; strings may be NULL.
struct options_surroundings {
    const char *home, *xdg_state_home, *xdg_config_home, *xdg_runtime_dir, *marchd_socket; // environment variables
    const char *config_path;    // the system's file: read for root and with --system, unless --config names another
    const char *current_folder; // absolute; relative paths start there
    const char *program_folder; // absolute; the default folder of march-worker
    bool is_root;
};

// Strings are owned, paths are absolute. The zero value is empty.
struct options {
    char *state_folder;
    char *socket_path;
    struct path_list output_roots; // at least one; relative output paths go below the first
    struct path_list input_roots;  // at least one
    char *worker_program;
    char *shader_folder; // NULL: the shaders inside the worker
    char *backend;       // "auto", "egl", "osmesa" or "software"
    char *admin_group;   // name of a group
    char *web_user;      // name of the user of march-web; empty: none
    int worker_count;    // of this machine; 0: one per core, -1: none
    int thread_count;    // of one worker
    int max_attempts;
    int64_t stop_timeout_ms;
    int64_t progress_limit_ms; // a worker without progress for so long is killed
    int64_t frame_limit_ms;    // an attempt at a frame is ended after so long, unless its job states another limit
    // Limits of one user; 0: no limit.
    int64_t user_jobs;       // jobs that are not over
    int64_t user_frames;     // their frames that are not done
    int64_t user_pixels;     // pixels of those frames
    int64_t user_disk_bytes; // published files of jobs that are not deleted
    // How long jobs that are over stay in the queue; 0: until they are deleted.
    int64_t keep_jobs;  // so many of them
    int64_t keep_ms;    // for so long
    int64_t keep_bytes; // of files that they published
    // Shares of users who wait for workers.
    struct user_weights user_weights;
    int64_t half_life_ms;        // after so long half of what a user used is forgotten
    int64_t longest_wait_ms;     // after so long the jobs of one user and priority get a worker
    int64_t worker_memory_bytes; // memory of one worker; 0: its share of what there is, -1: any amount
    bool has_sandbox;            // workers run in the sandbox
    struct pool_table pools;     // of nodes
    struct job_notify notify;    // rules that hold for all jobs
    char *launch_socket;         // NULL, or march-launch's, which starts the pools' launchers for the daemon
    const char *version;         // borrowed; set by the program: what a node's must be, too
    enum log_level log_level;
    bool may_be_new;                               // a new store may be made where a farm was before
    char *backup_file;                             // NULL, or where to copy the store to, instead of serving
    char *restore_file;                            // NULL, or a copy to put in place of the store, instead of serving
    char *config_file;                             // NULL, or the file whose settings were read
    bool wants_check;                              // only the settings are to be checked
    bool wants_help, wants_version, wants_openrpc; // when one is true, nothing else is filled
};

// Called with each mistake of the command line, the environment and the file.
typedef void options_on_mistake(void *user, const char *mistake);

// False after a mistake; then the options are empty. After one of the file, its other lines are checked, too.
bool options_read(struct options *options, int argc, char **argv, const struct options_surroundings *surroundings,
                  options_on_mistake *on_mistake, void *user);
// Likewise; the error has the first mistake, and says how many more there are.
bool options_parse(struct options *options, int argc, char **argv, const struct options_surroundings *surroundings,
                   struct error *error);
void options_finish(struct options *options); // accepts the empty value
