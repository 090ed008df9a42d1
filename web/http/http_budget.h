// How many bytes of bodies and answers the connections hold in memory: of all, of one user or place, and of strangers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>

struct http_budget;
struct http_holder;

// One holder may have a quarter of all; those together whom the farm does not know a half.
enum { HTTP_BUDGET_HOLDER_PART = 4, HTTP_BUDGET_STRANGERS_PART = 2 };

// What one connection holds. The zero value holds nothing, is nobody's, and may hold nothing.
struct http_hold {
    struct http_holder *holder; // the budget's; NULL: nobody's
    size_t bytes;
};

struct http_budget *http_budget_create(size_t limit_bytes);
void http_budget_destroy(struct http_budget *budget);       // no hold has a holder; accepts NULL
size_t http_budget_bytes(const struct http_budget *budget); // that are held now

// From here on the hold is that of `name`: a user whom the farm knows, or else a place. What it has goes along, also
// over the new holder's limit.
void http_hold_assign(struct http_budget *budget, struct http_hold *hold, const char *name, bool is_user);
bool http_hold_take(struct http_hold *hold, size_t bytes); // false: it would be too much, and nothing is taken
void http_hold_give(struct http_hold *hold, size_t bytes); // gives some back
void http_hold_end(struct http_hold *hold);                // gives all back; accepts the zero value
