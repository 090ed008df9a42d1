// Why a function failed, as one sentence for the person who reads it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error {
    char message[1024]; // empty when nothing failed
};

// Every function takes NULL for `error` and does nothing then.
void error_set(struct error *error, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Puts "PREFIX: " before the message.
void error_prefix(struct error *error, const char *format, ...) __attribute__((format(printf, 2, 3)));
// Sets the formatted message, then ": " and the text of `errnum` (an errno value).
void error_set_errno(struct error *error, int errnum, const char *format, ...) __attribute__((format(printf, 3, 4)));
// True when `errnum` says that the program or the machine has too many open files: no fault of the file that was
// opened.
bool error_is_shortage(int errnum);
