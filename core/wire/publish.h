// Gives a finished part file its name: the one step that makes a frame visible, taken only by whoever owns the frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

#include <stdbool.h>
#include <stdint.h>

struct error;

// What the worker reported and what must be found.
struct published_file {
    uint64_t inode;
    uint64_t size_bytes;
    char hash[HASH_TEXT_SIZE];
};

// Renames `part` to `name` in `folder_fd` after checking that `part` is a regular file with that inode and size. Does not
// sync the folder: do so once a batch with publish_sync.
bool publish_file(int folder_fd, const char *part, const char *name, const struct published_file *expected,
                  struct error *error);
bool publish_sync(int folder_fd, struct error *error);

// After a crash between intent and result.
enum publish_state {
    PUBLISH_DONE,    // `name` holds the file
    PUBLISH_PENDING, // `part` holds it, whole: publish again
    PUBLISH_LOST     // neither does: render again
};
enum publish_state publish_settle(int folder_fd, const char *part, const char *name,
                                  const struct published_file *expected);
