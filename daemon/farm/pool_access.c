// SPDX-License-Identifier: Apache-2.0
#include "daemon/farm/pool_access.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "daemon/farm/farm.h"
#include "daemon/settings/options.h"

#include <stdlib.h>
#include <string.h>

static const struct pool_table *pools_of(const struct farm *farm)
{
    return &farm->options->pools;
}

// The set of one pool; `index` -1: this machine's.
static uint64_t bit_of(int index)
{
    return POOL_ACCESS_LOCAL << (index + 1);
}

static const char *name_of(const struct pool_table *table, int index)
{
    return index < 0 ? POOL_LOCAL : table->pools[index].name;
}

static const struct pool_terms *terms_of(const struct pool_table *table, int index)
{
    return index < 0 ? &table->local : &table->pools[index].terms;
}

uint64_t pool_access_all(const struct farm *farm)
{
    uint64_t set = farm->options->worker_count >= 0 ? POOL_ACCESS_LOCAL : 0;

    for (size_t i = 0; i < pools_of(farm)->count; i++)
        set |= bit_of((int)i);
    return set;
}

uint64_t pool_access_find(const struct farm *farm, const char *pool)
{
    const struct pool_table *table = pools_of(farm);
    uint64_t all = pool_access_all(farm), set = 0;

    for (int i = -1; i < (int)table->count; i++)
        if (!pool || strcmp(name_of(table, i), pool) == 0 || pool_terms_have_tag(terms_of(table, i), pool))
            set |= bit_of(i) & all;
    return set;
}

void pool_access_note_user(const struct farm *farm, struct quota_user *user, const struct rights_peer *peer)
{
    const struct pool_table *table = pools_of(farm);

    user->pools = 0;
    for (int i = -1; i < (int)table->count; i++)
        if (user->is_unlimited ||
            pool_terms_let(terms_of(table, i), user->uid, user->name, peer->groups, peer->group_count))
            user->pools |= bit_of(i);
}

// Puts `text` at the end of the owned list.
static char *add(char *list, const char *separator, const char *text)
{
    char *longer = list ? xasprintf("%s%s%s", list, separator, text) : xstrdup(text);

    free(list);
    return longer;
}

// Whether a pool before the one of that index has the tag.
static bool is_earlier(const struct farm *farm, int index, const char *tag)
{
    return (pool_access_find(farm, tag) & (bit_of(index) - 1)) != 0;
}

static void fail_unknown(const struct farm *farm, const char *pool, struct error *error)
{
    const struct pool_table *table = pools_of(farm);
    uint64_t all = pool_access_all(farm);
    char *names = NULL, *tags = NULL;

    for (int i = -1; i < (int)table->count; i++) {
        if (!(bit_of(i) & all)) continue;
        names = add(names, ", ", name_of(table, i));
        for (size_t k = 0; k < terms_of(table, i)->tag_count; k++)
            if (!is_earlier(farm, i, terms_of(table, i)->tags[k])) tags = add(tags, ", ", terms_of(table, i)->tags[k]);
    }
    error_set(error, "there is no pool or tag \"%s\" here: pools are %s%s%s", pool, names ? names : "not there",
              tags ? "; tags are " : "", tags ? tags : "");
    free(names);
    free(tags);
}

static void fail_denied(const struct farm *farm, const char *user, uint64_t asked, const char *pool,
                        struct error *error)
{
    const struct pool_table *table = pools_of(farm);
    char *list = NULL;

    for (int i = -1; i < (int)table->count; i++) {
        char *users, *text;

        if (!(bit_of(i) & asked)) continue;
        users = pool_terms_format_users(terms_of(table, i));
        text = xasprintf("%s is for %s", name_of(table, i), users);
        list = add(list, "; ", text);
        free(users);
        free(text);
    }
    if (pool)
        error_set(error, "%s may not use \"%s\": %s", user, pool, list);
    else
        error_set(error, "%s may use no pool of this farm: %s", user, list);
    free(list);
}

bool pool_access_check(const struct farm *farm, const struct quota_user *user, const char *pool, struct error *error)
{
    uint64_t asked = pool_access_find(farm, pool);

    if (asked == 0 && pool) {
        fail_unknown(farm, pool, error);
        return false;
    }
    if (asked != 0 && (asked & user->pools) == 0) {
        fail_denied(farm, user->name, asked, pool, error);
        return false;
    }
    return true;
}

uint64_t pool_access_find_barred(const struct farm *farm, const struct quota_user *user, const char *pool)
{
    uint64_t set = pool_access_find(farm, pool) & user->pools;

    return set == pool_access_all(farm) ? 0 : ~set;
}

void pool_access_refresh(struct farm *farm)
{
    for (size_t i = 0; i < farm->quota.count; i++) {
        struct quota_user *user = farm->quota.users[i];
        struct rights_peer peer = {.uid = user->uid};
        gid_t *groups = rights_find_groups(user->uid, user->name, &peer.group_count);

        peer.groups = groups;
        pool_access_note_user(farm, user, &peer);
        free(groups);
    }
    for (size_t i = 0; i < farm->jobs.count; i++) {
        const struct job_record *record = farm->jobs.records[i];
        uint64_t barred = pool_access_find_barred(farm, record->user, record->pool);

        if (barred != record->queued->turn.barred) queue_set_barred(farm->queue, record->queued, barred);
    }
}
