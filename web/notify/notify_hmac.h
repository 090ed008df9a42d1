// HMAC-SHA256: signs what a webhook gets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>

enum { NOTIFY_HMAC_SIZE = 65 }; // with the NUL

struct notify_bytes {
    const void *bytes; // borrowed
    size_t size_bytes;
};

// The HMAC of the parts, one after the other, in hexadecimal digits. RFC 2104.
void notify_hmac(const struct notify_bytes *secret, const struct notify_bytes *parts, size_t part_count,
                 char text[static NOTIFY_HMAC_SIZE]);
