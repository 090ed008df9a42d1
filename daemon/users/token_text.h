// The text of a token, which its holder keeps, and its hash, which the farm keeps.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;

enum {
    TOKEN_TEXT_SIZE = 51, // "marchd_", 43 characters of 256 random bits, and the end
    TOKEN_HASH_SIZE = 65, // SHA-256 in hexadecimal digits, and the end
    TOKEN_TEXT_LIMIT = 128
};

// A new token. False where the system gives no random bytes.
bool token_text_make(char text[static TOKEN_TEXT_SIZE], struct error *error);
void token_text_hash(const char *text, char hash[static TOKEN_HASH_SIZE]); // of any text
// Whether two hashes are the same, in a time that does not depend on what they are.
bool token_text_is_same(const char a[static TOKEN_HASH_SIZE], const char b[static TOKEN_HASH_SIZE]);
