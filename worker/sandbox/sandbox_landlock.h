// Which files this process may still reach, by the kernel's Landlock; what a kernel lacks is left out.
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

// The rules under way. The zero value is not open.
struct sandbox_landlock {
    int abi;         // of the kernel; 0: it has none, and the calls below do nothing
    int ruleset_fd;  // owned
    uint64_t rights; // of files, that are governed
};

bool sandbox_landlock_open(struct sandbox_landlock *landlock, struct error *error);
void sandbox_landlock_close(struct sandbox_landlock *landlock);
// The file, or the folder with all below it; `rights` are of enum sandbox_right.
bool sandbox_landlock_allow(const struct sandbox_landlock *landlock, int fd, unsigned rights, struct error *error);
// What is not there need not be allowed.
bool sandbox_landlock_allow_path(const struct sandbox_landlock *landlock, const char *path, unsigned rights,
                                 struct error *error);
// From here on this thread, and those it starts, reach what was allowed and nothing else: no other files, no TCP, no
// abstract sockets and no processes outside. No new privileges must have been given up before.
bool sandbox_landlock_enforce(const struct sandbox_landlock *landlock, struct error *error);
