// Publish intents whose outcome is not known: the daemon died, or the output root went away, while a file got its name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct job_record;
struct store_frame;

// Looks which of its two names the file of the intent has in the open folder of the job, by inode and hash, and gives
// it its name if that was not done. True when the file is published, on disk. `farm` is the farm's id. Blocking.
bool intent_settle(const struct job_record *record, const struct store_frame *row, const char *farm, int folder_fd);
