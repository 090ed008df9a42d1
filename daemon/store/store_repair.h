// Mends damaged rows of the store from the backup that is kept beside it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;
struct sqlite3;

// Puts the rows of FOLDER/backup.db in place of those whose sum is wrong, and adds jobs and documents that lack the
// other. Damaged frames, attempts, plans, roots and usages without a copy are removed; jobs and documents stay as they
// are, and their sums wrong. Each damaged row is a line of the log, up to a limit. `*count` (may be NULL) is their
// number. Outside a transaction; blocking.
bool store_repair(struct sqlite3 *db, const char *folder, int64_t *count, struct error *error);
