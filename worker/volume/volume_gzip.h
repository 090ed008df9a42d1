// Decompresses gzip as it comes in; zlib stays behind it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct volume_gzip;

struct volume_gzip *volume_gzip_create(void);
void volume_gzip_destroy(struct volume_gzip *gzip); // accepts NULL

// Turns some of `*in_size` bytes into some of `*out_size`; both become what was used. Members that follow each other
// count as one text, as RFC 1952 has it; a member's checksum is checked at its end.
bool volume_gzip_inflate(struct volume_gzip *gzip, const unsigned char *in, size_t *in_size, unsigned char *out,
                         size_t *out_size, struct error *error);
// True where the input may end: nothing has come in yet, or only whole members.
bool volume_gzip_is_complete(const struct volume_gzip *gzip);
