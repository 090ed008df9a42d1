// Whom the settings of march-web name: webhooks with their secrets, and commands.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;

enum { NOTIFY_TARGET_LIMIT = 64, NOTIFY_ARGUMENT_LIMIT = 64, NOTIFY_SECRET_LIMIT = 4096 };

// One of `url` and `arguments[0]` is set.
struct notify_target {
    char *name;                                 // owned
    char *url;                                  // owned
    char *secret_file;                          // owned; NULL: nothing is signed
    bool may_be_private;                        // its host may be of a private network
    char *arguments[NOTIFY_ARGUMENT_LIMIT + 1]; // owned; of a command, which ends in NULL
};

// The zero value is empty.
struct notify_targets {
    struct notify_target *targets; // owned; no name twice
    size_t count, capacity;
};

void notify_targets_finish(struct notify_targets *targets);
// Reads "NAME url=URL [secret=FILE] [private=yes|no]" or "NAME command=PROGRAM [ARGUMENT...]", whose arguments may
// stand in quotes.
bool notify_targets_add(struct notify_targets *targets, const char *text, struct error *error);
const struct notify_target *notify_targets_find(const struct notify_targets *targets, const char *name); // NULL: none

// Reads the secret of `path`, without a line feed at its end; owned by the caller. It must be a plain file that is not
// empty, that only its owner may write and strangers may not read.
bool notify_secret_load(const char *path, char **secret, size_t *size_bytes, struct error *error);
