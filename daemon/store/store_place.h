// Whether the files of an open store still have their names: what is written to one that lost it ends with the daemon.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <sys/types.h>

struct error;
struct sqlite3;

// The zero value knows of no log.
struct store_place {
    dev_t device; // of the write-ahead log
    ino_t inode;  // 0: not known
};

// Takes down the log of the database, which has been written to.
void store_place_note(struct store_place *place, const char *folder);
// False when queue.db or its log was removed or replaced. What was committed is then in queue.db, where that has its
// name; both may be put back.
bool store_place_check(const struct store_place *place, const char *folder, struct sqlite3 *db, struct error *error);
