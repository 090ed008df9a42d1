// Looks at the output roots again and again, off the loop, and marks those that are used for the first time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/farm/root_table.h"

#include <stdbool.h>

struct farm;
struct root_watch;
struct store_op;

// Called on the loop after a root that was there is not, or the reverse.
typedef void root_watch_on_change(struct farm *farm, struct root *root);

// Looks at each watched root every second, while it is not there or frames are to be rendered. `farm` is borrowed.
struct root_watch *root_watch_create(struct farm *farm, root_watch_on_change *on_change);
void root_watch_close(struct root_watch *watch);   // accepts NULL
void root_watch_destroy(struct root_watch *watch); // after the loop closed its handles; accepts NULL

// Looks at the root now. Blocking. True when it has got its id, which is then to be stored.
bool root_watch_look(struct farm *farm, struct root *root);
struct store_op root_watch_format_op(const struct root *root); // an op that stores the root's id
