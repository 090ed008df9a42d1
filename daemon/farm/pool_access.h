// Which pools' workers render which job: those that it asks for, of those that its owner may use.
// SPDX-License-Identifier: Apache-2.0
//
// Sets of pools are bits: POOL_ACCESS_LOCAL is this machine's, 1 << (i + 1) that of index i in the settings.
// Administrators may use all pools.
#pragma once

#include "daemon/users/rights.h"

#include <stdbool.h>
#include <stdint.h>

struct error;
struct farm;
struct quota_user;

#define POOL_ACCESS_LOCAL UINT64_C(1)

uint64_t pool_access_all(const struct farm *farm); // the pools that there are
// Those that have the name or tag; NULL: all. 0: none.
uint64_t pool_access_find(const struct farm *farm, const char *pool);
// Sets which pools the user may use, to be called after their rights were looked at.
void pool_access_note_user(const struct farm *farm, struct quota_user *user, const struct rights_peer *peer);
// False, with the reason, when no pool's workers render the user's jobs that ask for `pool` (NULL: any).
bool pool_access_check(const struct farm *farm, const struct quota_user *user, const char *pool, struct error *error);
// The pools that do not, as struct turns_job has them.
uint64_t pool_access_find_barred(const struct farm *farm, const struct quota_user *user, const char *pool);
// To be called when jobs are restored and when settings or rights changed, after limits_refresh: looks at all users,
// in the user database, which may block, and at all jobs.
void pool_access_refresh(struct farm *farm);
