// Options of march-web, from the command line, the environment, a file and defaults, in that order of precedence.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/log.h"
#include "web/notify/notify_target.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

// The surroundings that the defaults depend on. Borrowed; strings may be NULL.
struct web_surroundings {
    const char *home, *xdg_config_home, *xdg_runtime_dir, *xdg_state_home, *marchd_socket; // environment variables
    const char *config_path;    // the system's file: read for root and with --system, unless --config names another
    const char *current_folder; // absolute; relative paths start there
    const char *data_folder;    // where the installed page is
    const char *program_folder; // of this program; the worker is beside it
    const char *xdg_cache_home, *cache_directory; // environment variables, the second the service manager's
    bool is_root;
};

// Strings are owned, paths are absolute. The zero value is empty.
struct web_options {
    char *socket_path; // the daemon's
    char *listen;      // "127.0.0.1:8470"
    char *page_folder;
    char *document_folder; // of openrpc.json and schema.json
    char *chart_file;      // the charting library
    char **origins;        // as written; checked by who uses them
    size_t origin_count, origin_capacity;
    int connection_limit, address_limit;
    int64_t buffer_bytes; // of bodies and answers that wait
    int64_t send_time_ms; // for an answer to leave
    char *worker_program; // makes pictures of frames
    char *cache_folder;   // where they are kept
    int64_t cache_bytes, picture_memory_bytes, picture_time_ms;
    int picture_workers;
    struct notify_targets notify_targets; // whom jobs may name
    bool notify_webhooks;                 // jobs may name addresses
    int64_t notify_timeout_ms;            // of one attempt to tell one
    int64_t notify_keep_ms;               // so long a notice is tried
    enum log_level log_level;
    char *config_file;              // NULL, or the file whose settings were read
    bool wants_check;               // only the settings are to be checked
    bool wants_help, wants_version; // when true, nothing else is filled
};

// Called with each mistake of the command line, the environment and the file.
typedef void web_options_on_mistake(void *user, const char *mistake);

// False after a mistake; then the options are empty. After one of the file, its other lines are checked, too.
bool web_options_read(struct web_options *options, int argc, char **argv, const struct web_surroundings *surroundings,
                      web_options_on_mistake *on_mistake, void *user);
void web_options_finish(struct web_options *options); // accepts the empty value
