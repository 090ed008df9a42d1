// Which calls of the kernel this process may still make: a renderer's, by a list; all others are answered ENOSYS.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

struct sandbox_calls {
    bool has_programs;    // may start others, and end them
    bool has_all_threads; // the threads that run already are held to it too
};

// Gives up new privileges as well.
bool sandbox_seccomp_enter(const struct sandbox_calls *calls, struct error *error);
