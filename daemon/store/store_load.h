// Reads the rows of the store that the queue keeps in memory.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/store/store_op.h"

struct error;
struct sqlite3;

// As store_load.
bool store_load_rows(struct sqlite3 *db, store_on_job *on_job, store_on_frame *on_frame, void *user,
                     struct error *error);
