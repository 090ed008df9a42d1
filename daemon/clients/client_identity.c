// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/client_identity.h"

#include "core/base/alloc.h"
#include "daemon/clients/client.h"

#include <stdlib.h>

static void set_peer(struct client *client, struct rights_peer peer, gid_t *groups)
{
    free(client->groups);
    client->groups = groups;
    client->peer = peer;
    client->peer.groups = groups;
}

void client_identity_drop(struct client *client)
{
    set_peer(client, (struct rights_peer){.uid = -1}, NULL);
    client->access.kind = ACCESS_DROPPED;
}

bool client_identity_has_room(const struct client *client, int64_t uid)
{
    const struct client_account *account = client_accounts_find(client->host->accounts, uid);

    return !account || account == client->outgoing.account || account->client_count < CLIENT_ACCOUNT_CLIENTS;
}

void client_identity_take(struct client *client, const struct client_identity *identity)
{
    if (client->is_closing) {
        free(identity->groups);
        return;
    }
    client_change_account(client, identity->uid);
    set_peer(client,
             (struct rights_peer){.uid = identity->uid,
                                  .group_count = identity->group_count,
                                  .is_ordinary = identity->access.scope != SCOPE_ADMIN},
             identity->groups);
    free(client->user);
    client->user = xstrdup(identity->user);
    client->access = identity->access;
}

// A long message that is being read off the loop is handled after this: with no rights.
static void end_token(struct client *client, const char *why)
{
    client->access.kind = ACCESS_DROPPED;
    client_refuse(client, MESSAGE_CODE_NOT_ALLOWED, why);
}

void client_identity_end_token(struct client *client, int64_t token, const char *why)
{
    while (client->previous)
        client = client->previous;
    for (; client; client = client->next)
        if (client->access.kind == ACCESS_TOKEN && client->access.token == token && !client->is_closing)
            end_token(client, why);
}

void client_identity_check(struct client *client, int64_t now_ms)
{
    if (access_has_expired(&client->access, now_ms) && !client->is_closing) end_token(client, "token: it has expired");
}
