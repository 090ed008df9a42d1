// Gives a finished part file its name. This step makes a frame visible; only the owner of the frame takes it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

#include <stdbool.h>
#include <stdint.h>

struct error;

// The file that the worker reported, and that must be found.
struct published_file {
    uint64_t inode;
    uint64_t size_bytes;
    char hash[HASH_TEXT_SIZE];
};

// Waits until `part` is seen as it is expected, for a part file that another machine wrote: what network file systems
// show of it may be old. At most so long; then publish_file says what is wrong. Blocking.
void publish_await(int folder_fd, const char *part, const struct published_file *expected, int64_t limit_ms);

// Renames `part` to `name` in `folder_fd` after checking that `part` is a regular file with that inode and size. A
// rename that fails is looked at: where `name` is the file afterwards, it was done, as a network file system may do it
// and answer that there is no `part` any more. The folder is synced by publish_sync, once a batch.
bool publish_file(int folder_fd, const char *part, const char *name, const struct published_file *expected,
                  struct error *error);
bool publish_sync(int folder_fd, struct error *error);

// Whether `name` is a regular file of that size and hash, whatever its inode.
bool publish_check_found(int folder_fd, const char *name, const struct published_file *expected, struct error *error);

// What is found after a crash between intent and result.
enum publish_state {
    PUBLISH_DONE,    // `name` holds the file
    PUBLISH_PENDING, // `part` holds it, whole: publish again
    PUBLISH_LOST     // neither does: render again
};
enum publish_state publish_settle(int folder_fd, const char *part, const char *name,
                                  const struct published_file *expected);
