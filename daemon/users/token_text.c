// SPDX-License-Identifier: Apache-2.0
#include "daemon/users/token_text.h"

#include "core/base/error.h"

#include <assert.h>
#include <errno.h>
#include <sha2.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/random.h>

#define PREFIX "marchd_" // by which people and programs that look for lost secrets know a token

enum { RANDOM_BYTES = 32, BITS_OF_A_DIGIT = 6, DIGITS = (RANDOM_BYTES * 8 + BITS_OF_A_DIGIT - 1) / BITS_OF_A_DIGIT };

static_assert(sizeof PREFIX + DIGITS == TOKEN_TEXT_SIZE, "the text is the prefix and the digits");
static_assert(SHA256_DIGEST_STRING_LENGTH == TOKEN_HASH_SIZE, "the hash is SHA-256 in hexadecimal digits");

// Base 64 as in URLs, the last digit filled up with zeros.
static void write_digits(const uint8_t bytes[static RANDOM_BYTES], char *text)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    unsigned bits = 0;
    int bit_count = 0, next = 0;

    for (int i = 0; i < DIGITS; i++) {
        if (bit_count < BITS_OF_A_DIGIT) {
            bits = (bits & 0xffU) << 8 | (next < RANDOM_BYTES ? bytes[next] : 0U);
            next++;
            bit_count += 8;
        }
        bit_count -= BITS_OF_A_DIGIT;
        text[i] = digits[bits >> bit_count & 0x3fU];
    }
    text[DIGITS] = '\0';
}

bool token_text_make(char text[static TOKEN_TEXT_SIZE], struct error *error)
{
    uint8_t bytes[RANDOM_BYTES];

    if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes) {
        error_set_errno(error, errno, "cannot get random bytes");
        return false;
    }
    memcpy(text, PREFIX, sizeof PREFIX);
    write_digits(bytes, text + sizeof PREFIX - 1);
    explicit_bzero(bytes, sizeof bytes);
    return true;
}

void token_text_hash(const char *text, char hash[static TOKEN_HASH_SIZE])
{
    SHA256Data((const uint8_t *)text, strlen(text), hash);
}

// No branch and no index depends on a digit; `volatile` keeps a compiler from ending the loop early.
bool token_text_is_same(const char a[static TOKEN_HASH_SIZE], const char b[static TOKEN_HASH_SIZE])
{
    volatile unsigned difference = 0;

    for (size_t i = 0; i < TOKEN_HASH_SIZE; i++)
        difference |= (unsigned char)a[i] ^ (unsigned char)b[i];
    return difference == 0;
}
