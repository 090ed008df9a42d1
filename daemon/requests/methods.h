// All methods of docs/protocol.md that clients call, by subject.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/requests/method.h"

// Each ends in a method without a name.
extern const struct method methods_of_daemon[];
extern const struct method methods_of_tokens[];
extern const struct method methods_of_jobs[];    // they tell of jobs
extern const struct method methods_of_changes[]; // they change jobs
extern const struct method methods_of_notices[];

enum { METHOD_LIMIT = 64, METHOD_PARAM_LIMIT = 24 };

// Walks them in the order of the protocol: start with {0}; NULL at the end.
struct methods_walk {
    size_t table, row;
};
const struct method *methods_next(struct methods_walk *walk);
const struct method *methods_find(const char *name); // NULL: there is no such method
const char *methods_find_nearest(const char *name);  // the name that is probably meant, or NULL
void methods_list_keys(const struct method *method, const char *keys[static METHOD_PARAM_LIMIT + 1]); // ends in NULL
