// Weights of users, by name: "anna=2".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct error;

struct user_weight {
    char *name; // owned; a user's name, or their uid in digits
    double weight;
};

// The zero value is empty.
struct user_weights {
    struct user_weight *weights; // owned; no name twice
    size_t count, capacity;
};

void user_weights_finish(struct user_weights *weights);
// Reads "NAME=NUMBER" with a number in [0.01, 100]. A name that is known gets the new weight.
bool user_weights_add(struct user_weights *weights, const char *text, struct error *error);
double user_weights_find(const struct user_weights *weights, int64_t uid, const char *name); // 1: not named
bool user_weights_are_same(const struct user_weights *a, const struct user_weights *b);
