// Hashes of files' contents, kept as long as the files do not change.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"

#include <stdbool.h>
#include <sys/types.h>
#include <time.h>

struct error;
struct file_hashes;

// What tells a file from the same file after it was written to or replaced.
struct file_version {
    dev_t device;
    ino_t inode;
    off_t size_bytes;
    struct timespec modified, changed;
};

bool file_version_find(const char *path, struct file_version *version, struct error *error);
// Returns false for a file that was written so recently that another write may leave the same version.
bool file_version_is_settled(const struct file_version *version);
bool file_version_is_same(const struct file_version *a, const struct file_version *b);

struct file_hashes *file_hashes_create(void);
void file_hashes_destroy(struct file_hashes *hashes); // accepts NULL

// Finds the hash of all bytes of the file at `path`, and the file's version. A file that changes meanwhile is an error.
bool file_hashes_find(struct file_hashes *hashes, const char *path, struct file_version *version,
                      char hash[static HASH_TEXT_SIZE], struct error *error);
