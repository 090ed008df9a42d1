// What a pool asks Slurm for: settings of launcher=slurm.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/settings/option_words.h"

#include <stdbool.h>
#include <stdint.h>

struct error;

enum { SLURM_ALLOCATION_LIMIT = 1024 };

// Strings are owned. The zero value is empty.
struct slurm_options {
    char *partition, *account, *gres, *time; // as sbatch takes them; NULL: Slurm's default
    struct option_words arguments;           // further ones of sbatch
    int min, max;                            // allocations, of one machine each
    int cpu_count;                           // of one; 0: one for each thread of its workers
    int64_t idle_ms;                         // an allocation with nothing to do for so long is given back
    int64_t keep_ms;                         // one ends by itself when the daemon is gone for so long
    char *lease_folder;                      // absolute; NULL: in the first output root
};

extern const char slurm_options_keys[]; // for messages: "partition, account, ..."

void slurm_options_init(struct slurm_options *options); // defaults
void slurm_options_finish(struct slurm_options *options);
// Reads one setting. `*is_known` is false for a key that is none of Slurm's; then nothing is read.
bool slurm_options_read(struct slurm_options *options, const char *key, const char *value, bool *is_known,
                        struct error *error);
bool slurm_options_check(const struct slurm_options *options, struct error *error); // when all are read
