// SPDX-License-Identifier: Apache-2.0
#include "daemon/settings/user_weights.h"

#include "core/base/alloc.h"
#include "core/base/error.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double LEAST = 0.01, MOST = 100;

void user_weights_finish(struct user_weights *weights)
{
    for (size_t i = 0; i < weights->count; i++)
        free(weights->weights[i].name);
    free(weights->weights);
    *weights = (struct user_weights){0};
}

static struct user_weight *find(const struct user_weights *weights, const char *name)
{
    for (size_t i = 0; i < weights->count; i++)
        if (strcmp(weights->weights[i].name, name) == 0) return &weights->weights[i];
    return NULL;
}

bool user_weights_add(struct user_weights *weights, const char *text, struct error *error)
{
    const char *equals = strchr(text, '=');
    char *end = NULL;
    double weight = equals ? strtod(equals + 1, &end) : 0;
    struct user_weight *known;
    char *name;

    if (!equals || equals == text || end == equals + 1 || *end || !(weight >= LEAST && weight <= MOST)) {
        error_set(error, "--user-weight: expected NAME=NUMBER from 0.01 to 100, as in anna=2, got \"%s\"", text);
        return false;
    }
    name = xstrndup(text, (size_t)(equals - text));
    known = find(weights, name);
    if (known) {
        known->weight = weight;
        free(name);
        return true;
    }
    weights->weights = xgrow(weights->weights, &weights->capacity, weights->count + 1, sizeof weights->weights[0]);
    weights->weights[weights->count++] = (struct user_weight){name, weight};
    return true;
}

double user_weights_find(const struct user_weights *weights, int64_t uid, const char *name)
{
    const struct user_weight *found = find(weights, name);
    char digits[24];

    snprintf(digits, sizeof digits, "%" PRId64, uid);
    if (!found) found = find(weights, digits);
    return found ? found->weight : 1;
}

bool user_weights_are_same(const struct user_weights *a, const struct user_weights *b)
{
    if (a->count != b->count) return false;
    for (size_t i = 0; i < a->count; i++) {
        const struct user_weight *other = find(b, a->weights[i].name);

        if (!other || other->weight != a->weights[i].weight) return false;
    }
    return true;
}
