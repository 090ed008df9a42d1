// SPDX-License-Identifier: Apache-2.0
#include "daemon/users/access.h"

#include <stddef.h>

const char *const access_scope_names[] = {"read", "submit", "admin", NULL};

bool access_find_scope(enum access_need need, enum access_scope *scope)
{
    if (need < NEED_READ || need > NEED_ADMIN) return false;
    *scope = (enum access_scope)(need - NEED_READ);
    return true;
}

bool access_allows(const struct access *access, enum access_need need)
{
    enum access_scope needed;

    switch (access->kind) {
    case ACCESS_PEER:
        return true;
    case ACCESS_TOKEN:
        return need == NEED_NOTHING || (access_find_scope(need, &needed) && needed <= access->scope);
    case ACCESS_DROPPED:
        break;
    }
    return need == NEED_NOTHING;
}

bool access_has_expired(const struct access *access, int64_t now_ms)
{
    return access->expires_ms > 0 && now_ms >= access->expires_ms;
}
