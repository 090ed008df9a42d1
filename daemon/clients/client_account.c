// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/client_account.h"

#include "core/base/alloc.h"

#include <stdlib.h>

struct client_account *client_accounts_join(struct client_accounts *accounts, int64_t uid)
{
    struct client_account *account = accounts->first;

    while (account && account->uid != uid)
        account = account->next;
    if (!account) {
        account = xcalloc(1, sizeof *account);
        account->uid = uid;
        account->next = accounts->first;
        accounts->first = account;
    }
    account->client_count++;
    return account;
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
