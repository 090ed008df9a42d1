// Hashes of bytes: 128 bits of a file or a job, 64 bits of a row (XXH3, which is no protection against forgery).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HASH_TEXT_SIZE = 33 }; // 32 lower-case hexadecimal digits and NUL

struct error;

void hash_bytes(const void *bytes, size_t size_bytes, char text[static HASH_TEXT_SIZE]);
uint64_t hash_bytes_short(const void *bytes, size_t size_bytes, uint64_t seed); // 64 bits (XXH3 with a seed)
// Hashes all of `fd` from its start; `*size_bytes` (may be NULL) receives its size.
bool hash_file(int fd, char text[static HASH_TEXT_SIZE], uint64_t *size_bytes, struct error *error);
