// SPDX-License-Identifier: Apache-2.0
#include "daemon/schedule/plan_desk.h"

#include "core/base/alloc.h"

#include <stdlib.h>
#include <string.h>

static bool is_key(const struct plan_key *a, const struct plan_key *b)
{
    return a->owner_uid == b->owner_uid && strcmp(a->scene, b->scene) == 0 && strcmp(a->segment, b->segment) == 0;
}

static bool is_asker(const struct plan_asker *a, const struct plan_asker *b)
{
    return a->job == b->job && a->frame == b->frame && a->attempt == b->attempt;
}

static void remove_errand(struct plan_errand **link)
{
    struct plan_errand *errand = *link;

    *link = errand->next;
    free(errand->askers);
    free(errand);
}

void plan_desk_finish(struct plan_desk *desk)
{
    while (desk->errands)
        remove_errand(&desk->errands);
}

// The link to the errand; to NULL: there is none.
static struct plan_errand **find_errand(struct plan_desk *desk, const struct plan_key *key)
{
    struct plan_errand **link = &desk->errands;

    while (*link && !is_key(&(*link)->key, key))
        link = &(*link)->next;
    return link;
}

bool plan_desk_is_busy(const struct plan_desk *desk, const struct plan_key *key)
{
    return *find_errand((struct plan_desk *)desk, key) != NULL;
}

bool plan_desk_ask(struct plan_desk *desk, const struct plan_key *key, const struct plan_asker *asker)
{
    struct plan_errand **link = find_errand(desk, key), *errand = *link;

    if (!errand) {
        errand = *link = xcalloc(1, sizeof *errand);
        errand->key = *key;
    }
    for (size_t i = 0; i < errand->count; i++)
        if (is_asker(&errand->askers[i], asker)) return i == 0 && !errand->is_made;
    errand->askers = xgrow(errand->askers, &errand->capacity, errand->count + 1, sizeof *errand->askers);
    errand->askers[errand->count++] = *asker;
    return errand->count == 1 && !errand->is_made;
}

bool plan_desk_is_maker(const struct plan_desk *desk, const struct plan_key *key, const struct plan_asker *asker)
{
    const struct plan_errand *errand = *find_errand((struct plan_desk *)desk, key);

    return errand && !errand->is_made && is_asker(&errand->askers[0], asker);
}

bool plan_desk_begin_commit(struct plan_desk *desk, const struct plan_key *key, const struct plan_asker *maker)
{
    if (!plan_desk_is_maker(desk, key, maker)) return false;
    (*find_errand(desk, key))->is_made = true;
    return true;
}

struct plan_asker *plan_desk_close(struct plan_desk *desk, const struct plan_key *key, size_t *count)
{
    struct plan_errand **link = find_errand(desk, key);
    struct plan_asker *askers = NULL;

    *count = 0;
    if (!*link) return NULL;
    askers = (*link)->askers;
    *count = (*link)->count;
    (*link)->askers = NULL;
    remove_errand(link);
    return askers;
}

// Removes the asker; true when it was the first.
static bool remove_asker(struct plan_errand *errand, const struct plan_asker *asker)
{
    for (size_t i = 0; i < errand->count; i++) {
        if (!is_asker(&errand->askers[i], asker)) continue;
        errand->count--;
        memmove(&errand->askers[i], &errand->askers[i + 1], (errand->count - i) * sizeof *errand->askers);
        return i == 0;
    }
    return false;
}

bool plan_desk_leave(struct plan_desk *desk, const struct plan_asker *asker, struct plan_key *key,
                     struct plan_asker *next)
{
    for (struct plan_errand **link = &desk->errands; *link; link = &(*link)->next) {
        struct plan_errand *errand = *link;

        if (!remove_asker(errand, asker) || errand->is_made) continue;
        if (errand->count == 0) {
            remove_errand(link);
            return false;
        }
        *key = errand->key;
        *next = errand->askers[0];
        return true;
    }
    return false;
}
