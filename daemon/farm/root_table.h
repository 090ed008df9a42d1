// The output roots that the farm knows: those of its settings and those of its jobs, and whether each is there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/job/root_marker.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Where a folder was found; another mount of the same disk is another place.
struct root_place {
    uint64_t device, inode, mount;
};

// A root lives as long as its table. Threads may read `path`, and `id` of a root that has been there.
struct root {
    char *path;                   // owned
    char id[ROOT_MARKER_ID_SIZE]; // of its marker; "": it has never been there, or is not marked yet
    bool is_there;                // at the latest look
    char *trouble;                // owned; why it is not there; NULL where it is
    struct root_place place;      // at the latest look that found it
    int64_t generation;           // grows when it is found in another place: what was opened before is no longer it
    bool is_watched;              // it is in the settings, or a job has it
    bool is_being_looked_at;      // on another thread
};

// The zero value is empty.
struct root_table {
    struct root **roots; // owned; in the order of their addition
    size_t count, capacity;
};

void root_table_finish(struct root_table *table);
struct root *root_table_find(const struct root_table *table, const char *path); // NULL: none
struct root *root_table_add(struct root_table *table, const char *path);        // found, or new

void root_set_trouble(struct root *root, const char *trouble); // copies; the root is not there
char *root_format_reason(const struct root *root);             // why its jobs wait; owned by the caller
// The root is there. Returns whether it was found in another place than before.
bool root_set_place(struct root *root, const struct root_place *place);
