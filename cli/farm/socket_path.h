// The paths at which the daemon's socket is expected.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

// Each may be NULL; empty strings count as absent.
struct socket_path_params {
    const char *option;         // --socket
    const char *environment;    // $MARCHD_SOCKET
    const char *system_path;    // the installed service's socket
    const char *runtime_folder; // $XDG_RUNTIME_DIR
    const char *state_home;     // $XDG_STATE_HOME
    const char *home;           // $HOME
};

#define SOCKET_PATH_SYSTEM "/run/marchd/marchd.sock"

// The zero value is empty.
struct socket_path_list {
    char *paths[2]; // owned
    size_t count;
};

// Lists the paths to try, in order: the option alone, else the environment alone, else the system's socket and that of
// a daemon that the user started, in the runtime folder or else in the state folder.
void socket_path_choose(struct socket_path_list *list, const struct socket_path_params *params);
void socket_path_finish(struct socket_path_list *list); // accepts an empty list
