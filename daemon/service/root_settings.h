// Brings the output roots of store, jobs and settings into the farm's table, and says in the log which are missing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>

struct error;
struct farm;
struct path_list;
struct store_op;

// Called with an op that stores a root; it takes the op over.
typedef void root_settings_on_op(void *user, struct store_op op);

// Reads the farm's id and its roots from the store; to be called before jobs are loaded.
bool root_settings_load(struct farm *farm, struct error *error);
// Looks at all roots that are new since the last call: those of the jobs and `roots`, of the settings. Blocking. The
// first of the settings is made if neither the store nor a job knows it. A root that is missing is no error.
void root_settings_take(struct farm *farm, const struct path_list *roots, root_settings_on_op *on_op, void *user);
// Says in the log which input roots are not there. Blocking.
void root_settings_tell_inputs(const struct path_list *roots);
