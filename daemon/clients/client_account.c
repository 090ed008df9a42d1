// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/client_account.h"

#include "core/base/alloc.h"

#include <assert.h>
#include <stdlib.h>

struct client_account *client_accounts_find(const struct client_accounts *accounts, int64_t uid)
{
    struct client_account *account = accounts->first;

    while (account && account->uid != uid)
        account = account->next;
    return account;
}

struct client_account *client_accounts_join(struct client_accounts *accounts, int64_t uid)
{
    struct client_account *account = client_accounts_find(accounts, uid);

    if (!account) {
        account = xcalloc(1, sizeof *account);
        account->uid = uid;
        account->next = accounts->first;
        accounts->first = account;
    }
    account->client_count++;
    return account;
}

bool client_account_take_place(struct client_account *account)
{
    if (account->long_lines == CLIENT_ACCOUNT_LONG_LINES) return false;
    account->long_lines++;
    return true;
}

void client_account_give_place(struct client_account *account)
{
    assert(account->long_lines > 0);
    account->long_lines--;
}

void client_accounts_leave(struct client_accounts *accounts, struct client_account *account)
{
    struct client_account **link = &accounts->first;

    if (--account->client_count > 0) return;
    while (*link != account)
        link = &(*link)->next;
    *link = account->next;
    free(account);
}
