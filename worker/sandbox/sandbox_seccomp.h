// Confines this process to the system calls of a renderer; all others return ENOSYS.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

struct sandbox_calls {
    bool has_programs;    // it may start programs, and end them
    bool has_all_threads; // running threads are confined too
};

// Sets PR_SET_NO_NEW_PRIVS as well.
bool sandbox_seccomp_enter(const struct sandbox_calls *calls, struct error *error);
