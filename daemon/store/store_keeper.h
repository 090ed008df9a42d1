// Looks after the store in the background: finds damaged rows and mends them, and keeps a backup.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include <uv.h>

struct store_keeper;

typedef bool store_keeper_may_run(void *user);   // false: not now, as while the disk is full
typedef void store_keeper_on_repair(void *user); // rows were damaged and mended: what is in memory is to be stored anew

struct store_keeper_params {
    const char *folder;            // copied
    int64_t first_ms, interval_ms; // from the opening to the first look, and between looks; at least 1
    store_keeper_may_run *may_run;
    store_keeper_on_repair *on_repair;
    void *user; // borrowed
};

// A look takes a connection of its own, off the loop: first the sums of all rows, and the mending of damaged ones; then
// FOLDER/backup.db, when the store has changed since the last.
struct store_keeper *store_keeper_open(uv_loop_t *loop, const struct store_keeper_params *params);
int64_t store_keeper_looks(const struct store_keeper *keeper); // count of those that have ended
void store_keeper_close(struct store_keeper *keeper);          // ends when a look under way does; accepts NULL
