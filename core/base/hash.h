// The 128-bit hash of a file's or a job's bytes (XXH3: finds accidents, keeps out nobody who means harm).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HASH_TEXT_SIZE = 33 }; // 32 lower-case hexadecimal digits and NUL

struct error;

void hash_bytes(const void *bytes, size_t size_bytes, char text[static HASH_TEXT_SIZE]);
// Hashes everything from the start of `fd`; `*size_bytes` (may be NULL) receives how much that was.
bool hash_file(int fd, char text[static HASH_TEXT_SIZE], uint64_t *size_bytes, struct error *error);
