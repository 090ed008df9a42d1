// What the connections of one user have together: how many they are, and the bytes that wait until they read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// A line may have 4 MiB, and be 16 times as large once it is read: only so many of a user are received at a time.
enum {
    CLIENT_ACCOUNT_LONG_LINES = 4,
    CLIENT_ACCOUNT_CLIENTS = 64,      // connections of one user
    CLIENT_ACCOUNT_WEB_CLIENTS = 1024 // of the web user, before they show tokens: each is somebody's page
};

struct client_account {
    int64_t uid;
    size_t client_count;
    size_t unread_bytes; // sent to them, not read yet
    size_t event_bytes;  // of these: events
    size_t long_lines;   // clients that have a place for a long line, CLIENT_ACCOUNT_LONG_LINES at most
    struct client_account *next;
};

// The accounts of users with a connection. The zero value is empty.
struct client_accounts {
    struct client_account *first; // list
};

// One client more of the user, whose account is made if there is none.
struct client_account *client_accounts_join(struct client_accounts *accounts, int64_t uid);
struct client_account *client_accounts_find(const struct client_accounts *accounts, int64_t uid); // NULL: there is none
// A place for a long line; false: there is none left. It is to be given back.
bool client_account_take_place(struct client_account *account);
void client_account_give_place(struct client_account *account);
// One less; an account without clients is freed.
void client_accounts_leave(struct client_accounts *accounts, struct client_account *account);
