// What the connections of one user have together: how many they are, and the bytes that wait until they read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stddef.h>
#include <stdint.h>

struct client_account {
    int64_t uid;
    size_t client_count;
    size_t unread_bytes; // sent to them, not read yet
    size_t event_bytes;  // of these: events
    struct client_account *next;
};

// The accounts of users with a connection. The zero value is empty.
struct client_accounts {
    struct client_account *first; // list
};

// One client more of the user, whose account is made if there is none.
struct client_account *client_accounts_join(struct client_accounts *accounts, int64_t uid);
// One less; an account without clients is freed.
void client_accounts_leave(struct client_accounts *accounts, struct client_account *account);
