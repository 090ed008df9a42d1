// The commands that a pool may run, each known by a few words: all that march-launch lets a daemon choose.
// SPDX-License-Identifier: Apache-2.0
#pragma once

struct error;
struct pool_options;

enum { POOL_COMMAND_WORD_LIMIT = 8 };

// `words` ends in NULL and is not trusted:
//   node NAME               starts that node of the pool
// And in a pool of Slurm's, where FARM is the farm's id and NUMBER that of an allocation, from 1:
//   step JOB                starts a node in Slurm's job
//   look FARM               lists the allocations
//   ask FARM NUMBER LEASE   asks for one, which ends without the lease, an absolute path
//   cancel FARM NUMBER JOB  gives it back
// The program and its arguments; ends in NULL; owned by the caller, freed with pool_options_free_command. NULL, with
// the reason, where the pool runs no such command.
char **pool_command_make(const struct pool_options *pool, const char *const words[], struct error *error);
