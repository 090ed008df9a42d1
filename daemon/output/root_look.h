// Looks whether an output root is there, and marks one that is used for the first time. Blocking.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/error.h"
#include "daemon/farm/root_table.h"

#include <stdbool.h>
#include <stddef.h>

// A look at one root. Pointers are borrowed, and outlive the look.
struct root_look {
    const char *path;
    const char *farm;             // the farm's id
    const char *state_folder;     // absolute; of the farm
    char **folders;               // folders that the root must hold, one of them at least, before it is marked
    size_t folder_count;          // 0: any folder is marked
    char id[ROOT_MARKER_ID_SIZE]; // in: the id that is expected; "": none is known. Out: the root's
    bool is_there, was_marked;    // results
    bool is_unknown;              // result: the daemon lacks descriptors, and nothing is known of the root
    struct root_place place;      // result, where it is there
    struct error error;           // result, where it is not
};

// An expected root is there if its marker has the id; an empty marker is given the id. An unknown root is marked,
// unless it has a marker, whose id is taken over.
void root_look_run(struct root_look *look);
