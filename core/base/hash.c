// SPDX-License-Identifier: Apache-2.0
#include "core/base/hash.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#include <xxhash.h>

enum { BLOCK_BYTES = 256 * 1024 };

static void format_hash(XXH128_hash_t hash, char text[static HASH_TEXT_SIZE])
{
    XXH128_canonical_t canonical;

    XXH128_canonicalFromHash(&canonical, hash);
    for (size_t i = 0; i < sizeof canonical.digest; i++)
        snprintf(text + 2 * i, 3, "%02x", canonical.digest[i]);
}

void hash_bytes(const void *bytes, size_t size_bytes, char text[static HASH_TEXT_SIZE])
{
    format_hash(XXH3_128bits(bytes, size_bytes), text);
}

uint64_t hash_bytes_short(const void *bytes, size_t size_bytes, uint64_t seed)
{
    return XXH3_64bits_withSeed(bytes, size_bytes, seed);
}

bool hash_file(int fd, char text[static HASH_TEXT_SIZE], uint64_t *size_bytes, struct error *error)
{
    bool ok = false;
    uint64_t total = 0;
    char *block = xmalloc(BLOCK_BYTES);
    XXH3_state_t *state = XXH3_createState();

    if (!state) {
        error_set(error, "out of memory");
        goto out;
    }
    XXH3_128bits_reset(state);
    for (;;) {
        ssize_t count = pread(fd, block, BLOCK_BYTES, (off_t)total);

        if (count < 0 && errno == EINTR) continue;
        if (count < 0) {
            error_set_errno(error, errno, "cannot read");
            goto out;
        }
        if (count == 0) break;
        XXH3_128bits_update(state, block, (size_t)count);
        total += (uint64_t)count;
    }
    format_hash(XXH3_128bits_digest(state), text);
    if (size_bytes) *size_bytes = total;
    ok = true;
out:
    XXH3_freeState(state);
    free(block);
    return ok;
}
