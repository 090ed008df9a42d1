// Opens the store when the service starts, and waits while its disk is full.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct error;
struct options;
struct store;
struct store_op;

// Whether the store may be made if there is none. A farm that lost its store must not begin a second one unasked: false
// where an output root, a backup or the ids in the state folder say that there was one, unless the options allow it.
bool opening_check_new(const struct options *options, struct error *error);
// As store_open, but tries again every second while the disk has no room for the start; the log and the service manager
// are told. A signal that ends the process ends the wait.
struct store *opening_wait(const char *folder, struct error *error);
// As store_commit, with the same wait.
bool opening_commit(struct store *store, const char *folder, const struct store_op *ops, size_t op_count,
                    struct error *error);
