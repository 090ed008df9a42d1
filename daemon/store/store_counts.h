// The last job id and epoch that a farm has used, in a file beside the store: neither begins again when the store does.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct error;

// Kept apart from the store, so that one restored from a backup, by whatever means, does not give ids a second time.
struct store_counts {
    int64_t last_job_id, epoch;
};

// Reads FOLDER/counts. False, and zero, when there is none or it is no such file.
bool store_counts_read(const char *folder, struct store_counts *counts);
// Writes it, larger numbers only, and syncs. A file that could not be written is as none.
bool store_counts_raise(const char *folder, const struct store_counts *counts, struct error *error);
