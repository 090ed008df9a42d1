// Where a frame's file is: below an output root, by no link, and which version of it is there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/base/hash.h"
#include "web/pictures/picture_status.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct path_list;
struct picture_query;

struct picture_place {
    char *folder, *name; // owned; folder is absolute
    uint64_t device, inode, size_bytes;
    int64_t changed_ns[2]; // of contents, and of the file
};

// Looks at the file at `path`. PICTURE_READY, or why it cannot be shown. The zero value is empty.
enum picture_status picture_place_find(struct picture_place *place, const struct path_list *roots, const char *path,
                                       struct error *error);
void picture_place_finish(struct picture_place *place);
// Another key for another version of the file and another picture of it.
void picture_place_make_key(const struct picture_place *place, const struct picture_query *query,
                            char key[static HASH_TEXT_SIZE]);
