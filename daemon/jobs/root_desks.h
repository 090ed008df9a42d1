// Work in the folders of output roots, off the loop: each root has a desk, so that one that hangs keeps few threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <uv.h>

struct root;
struct root_desks;
struct work_piece;

struct root_desks *root_desks_create(uv_loop_t *loop); // `loop` is borrowed until root_desks_destroy
void root_desks_destroy(struct root_desks *desks);     // when all pieces are done; accepts NULL
// As work_desk_put, at the desk of this root. `root` is borrowed.
void root_desks_put(struct root_desks *desks, const struct root *root, struct work_piece *piece);
