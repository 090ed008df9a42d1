// Confines this process to some files with the kernel's Landlock, as far as the kernel has it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;

enum sandbox_right {
    SANDBOX_READ = 1,  // files and the names in folders
    SANDBOX_WRITE = 2, // change, make and remove regular files
    SANDBOX_DEVICE = 4,
    SANDBOX_EXECUTE = 8
};

// A ruleset that is being built. The zero value is not open.
struct sandbox_landlock {
    int abi;          // the kernel's ABI version; 0: there is none, and the calls below do nothing
    const char *lack; // why there is none: the kernel, or a filter such as a container's; static
    int ruleset_fd;   // owned
    uint64_t rights;  // the rights on files that the ruleset governs
};

bool sandbox_landlock_open(struct sandbox_landlock *landlock, struct error *error);
void sandbox_landlock_close(struct sandbox_landlock *landlock);
// Allows a file, or a folder with all below it; `rights` are bits of enum sandbox_right.
bool sandbox_landlock_allow(const struct sandbox_landlock *landlock, int fd, unsigned rights, struct error *error);
// A path that does not exist is no error.
bool sandbox_landlock_allow_path(const struct sandbox_landlock *landlock, const char *path, unsigned rights,
                                 struct error *error);
// Confines this thread, and those it starts, to what was allowed: no other files, no TCP, no abstract sockets, no
// signals to processes outside. PR_SET_NO_NEW_PRIVS is set before.
bool sandbox_landlock_enforce(const struct sandbox_landlock *landlock, struct error *error);
