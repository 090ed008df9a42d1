// The commands of Slurm that a pool runs, and the script that an allocation runs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/settings/option_words.h"

#include <stdint.h>

struct pool_options;

// The names of the farm's allocations for the pool are "TOKEN.NUMBER", from 1. `farm` is the farm's id. Owned by the
// caller, as all that follows.
char *slurm_commands_format_token(const struct pool_options *pool, const char *farm);
// Lists all allocations, ended ones too: id, state, machine, time left, name and reason, with '|' between.
char **slurm_commands_make_look(const struct pool_options *pool, const char *farm);
char **slurm_commands_make_ask(const struct pool_options *pool, const char *farm, int number, const char *lease);
char **slurm_commands_make_cancel(const struct pool_options *pool, const char *farm, int number, int64_t job);
// The script of an allocation: it ends when the counter in the file `lease` stands still for so long by the clock of
// its machine.
char *slurm_commands_format_script(const char *lease, int64_t keep_ms);
