// Decompresses gzip data piece by piece. Only this module includes zlib.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct volume_gzip;

struct volume_gzip *volume_gzip_create(void);
void volume_gzip_destroy(struct volume_gzip *gzip); // accepts NULL

// Decompresses some of `*in_size` bytes into some of `*out_size` bytes; both become the number used. Members that
// follow each other are one text, as in RFC 1952. A member's checksum is checked at its end.
bool volume_gzip_inflate(struct volume_gzip *gzip, const unsigned char *in, size_t *in_size, unsigned char *out,
                         size_t *out_size, struct error *error);
// Returns true where the input may end: after no input, or after whole members.
bool volume_gzip_is_complete(const struct volume_gzip *gzip);
