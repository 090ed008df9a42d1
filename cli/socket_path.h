// Where the daemon's socket is expected.
#pragma once

// Each may be NULL.
struct socket_path_params {
    const char *option;         // --socket
    const char *environment;    // $MARCHD_SOCKET
    const char *system_path;    // the installed service's socket
    const char *runtime_folder; // $XDG_RUNTIME_DIR
};

#define SOCKET_PATH_SYSTEM "/run/marchd/marchd.sock"

// The option, else the environment, else the system's socket if there is one, else the one in the runtime folder, else the
// system's. Empty strings count as absent. Owned by the caller.
char *socket_path_choose(const struct socket_path_params *params);
