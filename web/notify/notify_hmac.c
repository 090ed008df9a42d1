// SPDX-License-Identifier: Apache-2.0
#include "web/notify/notify_hmac.h"

#include <sha2.h>
#include <stdio.h>
#include <string.h>

static void begin(SHA2_CTX *context, const uint8_t key[static SHA256_BLOCK_LENGTH], uint8_t pad)
{
    uint8_t block[SHA256_BLOCK_LENGTH];

    for (size_t i = 0; i < sizeof block; i++)
        block[i] = key[i] ^ pad;
    SHA256Init(context);
    SHA256Update(context, block, sizeof block);
    explicit_bzero(block, sizeof block);
}

void notify_hmac(const struct notify_bytes *secret, const struct notify_bytes *parts, size_t part_count,
                 char text[static NOTIFY_HMAC_SIZE])
{
    uint8_t key[SHA256_BLOCK_LENGTH] = {0}, digest[SHA256_DIGEST_LENGTH];
    SHA2_CTX context;

    if (secret->size_bytes > sizeof key) {
        SHA256Init(&context);
        SHA256Update(&context, secret->bytes, secret->size_bytes);
        SHA256Final(key, &context);
    } else if (secret->size_bytes > 0) {
        memcpy(key, secret->bytes, secret->size_bytes);
    }
    begin(&context, key, 0x36);
    for (size_t i = 0; i < part_count; i++)
        SHA256Update(&context, parts[i].bytes, parts[i].size_bytes);
    SHA256Final(digest, &context);
    begin(&context, key, 0x5c);
    SHA256Update(&context, digest, sizeof digest);
    SHA256Final(digest, &context);
    explicit_bzero(key, sizeof key);
    for (size_t i = 0; i < sizeof digest; i++)
        snprintf(text + 2 * i, 3, "%02x", digest[i]);
}
