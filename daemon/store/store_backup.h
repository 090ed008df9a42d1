// Copies of the store in one file, by SQLite's own call: whole and of one moment, while the store is in use.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct sqlite3;

#define STORE_BACKUP_NAME                                                                                              \
    "backup.db" // of the copy that the daemon keeps beside the store; a macro because texts hold it
#define STORE_RESTORED_NAME "queue.db.restored" // of a whole copy that is about to become the store

// Writes the database to `path`, with mode 0600, over a file that is there only once the copy is whole, checked and on
// disk. `known` damaged rows of the database may be in the copy; with more it is dropped, which is an error.
bool store_backup_write(struct sqlite3 *db, const char *path, int64_t known, struct error *error);
// Writes the store in `folder` to `path`, whether a daemon runs or not. The copy is checked: a damaged row is an error.
bool store_backup_save(const char *folder, const char *path, struct error *error);
// For a store that cannot be read: puts the copy that is kept beside it in its place, as store_backup_restore. The
// caller holds the lock. False, and nothing changed, without such a copy.
bool store_backup_fall_back(const char *folder, struct error *error);
// Puts a copy in place of the store in `folder`, which no daemon may use. The old one is kept as queue.db.replaced.
// Ids and epochs go on above those of both. `*has_counts` says whether the folder knew the last id that was ever given;
// where it did not, ids begin far above those of the copy.
bool store_backup_restore(const char *folder, const char *path, bool *has_counts, struct error *error);
// Ends a restore whose process died after it had put the old store aside. The caller holds the lock.
bool store_backup_end_restore(const char *folder, struct error *error);
