// SPDX-License-Identifier: Apache-2.0
#include "web/http/http_budget.h"

#include "core/base/alloc.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

struct http_holder {
    struct http_budget *budget;
    char *name; // owned
    bool is_user;
    size_t hold_count, bytes;
    struct http_holder *next; // on the budget's list
};

struct http_budget {
    size_t limit, bytes, strangers_bytes;
    struct http_holder *first; // owned
};

struct http_budget *http_budget_create(size_t limit_bytes)
{
    struct http_budget *budget = xcalloc(1, sizeof *budget);

    budget->limit = limit_bytes;
    return budget;
}

void http_budget_destroy(struct http_budget *budget)
{
    assert(!budget || !budget->first);
    free(budget);
}

size_t http_budget_bytes(const struct http_budget *budget)
{
    return budget->bytes;
}

static struct http_holder *find_or_add(struct http_budget *budget, const char *name, bool is_user)
{
    struct http_holder *holder;

    for (holder = budget->first; holder; holder = holder->next)
        if (holder->is_user == is_user && strcmp(holder->name, name) == 0) return holder;
    holder = xcalloc(1, sizeof *holder);
    *holder = (struct http_holder){.budget = budget, .name = xstrdup(name), .is_user = is_user, .next = budget->first};
    budget->first = holder;
    return holder;
}

static void remove_if_unused(struct http_holder *holder)
{
    struct http_holder **at = &holder->budget->first;

    if (holder->hold_count > 0) return;
    while (*at != holder)
        at = &(*at)->next;
    *at = holder->next;
    free(holder->name);
    free(holder);
}

static void add(struct http_holder *holder, size_t bytes)
{
    holder->bytes += bytes;
    holder->budget->bytes += bytes;
    if (!holder->is_user) holder->budget->strangers_bytes += bytes;
}

static void subtract(struct http_holder *holder, size_t bytes)
{
    holder->bytes -= bytes;
    holder->budget->bytes -= bytes;
    if (!holder->is_user) holder->budget->strangers_bytes -= bytes;
}

void http_hold_assign(struct http_budget *budget, struct http_hold *hold, const char *name, bool is_user)
{
    struct http_holder *holder = find_or_add(budget, name, is_user);

    if (holder == hold->holder) return;
    holder->hold_count++;
    add(holder, hold->bytes);
    if (hold->holder) {
        subtract(hold->holder, hold->bytes);
        hold->holder->hold_count--;
        remove_if_unused(hold->holder);
    }
    hold->holder = holder;
}

static bool fits(size_t held, size_t bytes, size_t limit)
{
    return held <= limit && bytes <= limit - held;
}

bool http_hold_take(struct http_hold *hold, size_t bytes)
{
    const struct http_budget *budget = hold->holder ? hold->holder->budget : NULL;

    if (bytes == 0) return true;
    if (!budget || !fits(budget->bytes, bytes, budget->limit) ||
        !fits(hold->holder->bytes, bytes, budget->limit / HTTP_BUDGET_HOLDER_PART))
        return false;
    if (!hold->holder->is_user && !fits(budget->strangers_bytes, bytes, budget->limit / HTTP_BUDGET_STRANGERS_PART))
        return false;
    hold->bytes += bytes;
    add(hold->holder, bytes);
    return true;
}

void http_hold_give(struct http_hold *hold, size_t bytes)
{
    assert(bytes <= hold->bytes);
    if (bytes == 0) return;
    hold->bytes -= bytes;
    subtract(hold->holder, bytes);
}

void http_hold_end(struct http_hold *hold)
{
    struct http_holder *holder = hold->holder;

    if (!holder) return;
    subtract(holder, hold->bytes);
    holder->hold_count--;
    remove_if_unused(holder);
    *hold = (struct http_hold){0};
}
