// A pool of nodes, machines whose workers a launcher starts: one setting, "NAME KEY=VALUE ...".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/settings/pool_terms.h"
#include "daemon/settings/slurm_options.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

// Nodes of a pool, workers of a node, pools of a farm.
enum { POOL_NODE_LIMIT = 4096, POOL_WORKER_LIMIT = 1024, POOL_LIMIT = 63 };
// Of all pools: a ticket names its worker in 16 bits, and this machine has workers, too.
enum { POOL_TABLE_WORKER_LIMIT = 60000 };

#define POOL_LOCAL "local" // the name of the pool of this machine's workers

enum pool_launcher {
    POOL_COMMAND, // any program that starts another one on a machine
    POOL_SSH,
    POOL_SLURM // machines that Slurm lends
};

struct pool_node {
    char *name;       // owned; as the launcher knows it
    int worker_count; // workers there, at least 1
};

// Strings are owned. The zero value is empty.
struct pool_options {
    char *name;
    enum pool_launcher launcher;
    struct pool_node *nodes; // owned; at least one
    size_t node_count;
    char **command; // owned, ends in NULL; "{node}" in a word stands for the node's name, of Slurm its job's id
    struct slurm_options slurm; // with POOL_SLURM
    char *backend;              // as of struct options; NULL: the same
    int thread_count;           // of one worker; 0: the same as here
    int64_t memory_bytes;       // of one worker; 0: its share of the node's, -1: any amount
    int64_t heartbeat_ms;       // a node that is silent for so long is lost
    bool wants_landlock;        // a node without Landlock is refused
    struct pool_terms terms;
    char *text; // the setting, without its terms
};

// The zero value is empty.
struct pool_table {
    struct pool_options *pools; // owned; names differ
    size_t count, capacity;     // count: at most POOL_LIMIT
    struct pool_terms local;    // of this machine's workers
};

// Reads the setting. That of the pool "local" has terms alone.
bool pool_table_add(struct pool_table *table, const char *text, struct error *error);
void pool_table_finish(struct pool_table *table);
bool pool_table_is_same(const struct pool_table *a, const struct pool_table *b); // but for the terms
// Swaps the terms of pools of the same name, and of "local". True if some of them differ.
bool pool_table_swap_terms(struct pool_table *table, struct pool_table *other);

// Reads the setting. Values that hold blanks are put in double quotes.
bool pool_options_read(struct pool_options *pool, const char *text, struct error *error);
void pool_options_finish(struct pool_options *pool); // accepts the empty value
int pool_options_worker_count(const struct pool_options *pool);
// The program and arguments that start a node; ends in NULL; owned by the caller, freed with pool_options_free_command.
char **pool_options_format_command(const struct pool_options *pool, const char *node);
void pool_options_free_command(char **command); // accepts NULL
