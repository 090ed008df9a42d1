// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/client_identity.h"

#include "core/base/alloc.h"
#include "core/json/json_write.h"
#include "daemon/clients/client.h"
#include "daemon/loop/memory_return.h"
#include "daemon/loop/work_desk.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

enum { CLIENT_COUNT = 3, PEER = 1000, ADA = 2000 };

// Clients of one peer, and the other ends of their connections.
struct stage {
    uv_loop_t loop;
    struct client_host host;
    struct client_accounts accounts;
    struct client *clients[CLIENT_COUNT]; // NULL: closed
    int ends[CLIENT_COUNT];
};

static void on_message(void *user, struct client *client, struct message *message)
{
}

static void on_closed(void *user, struct client *client)
{
    struct stage *stage = user;

    for (int i = 0; i < CLIENT_COUNT; i++)
        if (stage->clients[i] == client) stage->clients[i] = NULL;
    if (client->previous) client->previous->next = client->next;
    if (client->next) client->next->previous = client->previous;
    client_accounts_leave(&stage->accounts, client->outgoing.account);
}

static void make_stage(struct stage *stage)
{
    *stage = (struct stage){0};
    uv_loop_init(&stage->loop);
    stage->host = (struct client_host){.loop = &stage->loop,
                                       .turns = loop_turns_open(&stage->loop),
                                       .desk = work_desk_create(&stage->loop),
                                       .memory = memory_return_open(&stage->loop),
                                       .accounts = &stage->accounts,
                                       .on_message = on_message,
                                       .on_closed = on_closed,
                                       .user = stage};
    for (int i = 0; i < CLIENT_COUNT; i++) {
        int fds[2];
        struct client *client;

        assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, fds), 0);
        client = client_create(&stage->host, fds[0]);
        assert_non_null(client);
        client->outgoing.account = client_accounts_join(&stage->accounts, PEER);
        client->previous = i > 0 ? stage->clients[i - 1] : NULL;
        if (i > 0) stage->clients[i - 1]->next = client;
        stage->clients[i] = client;
        stage->ends[i] = fds[1];
        client_start(client);
    }
}

static void run_turns(struct stage *stage)
{
    for (int turn = 0; turn < 100; turn++)
        uv_run(&stage->loop, UV_RUN_NOWAIT);
}

static void finish_stage(struct stage *stage)
{
    for (int i = 0; i < CLIENT_COUNT; i++) {
        if (stage->clients[i]) client_close(stage->clients[i]);
        close(stage->ends[i]);
    }
    memory_return_close(stage->host.memory);
    loop_turns_close(stage->host.turns);
    uv_run(&stage->loop, UV_RUN_DEFAULT);
    assert_int_equal(uv_loop_close(&stage->loop), 0);
    work_desk_destroy(stage->host.desk);
    assert_null(stage->accounts.first);
}

static void take(struct client *client, int64_t token, enum access_scope scope, int64_t expires_ms)
{
    struct client_identity identity = {
        .uid = ADA,
        .user = "ada",
        .groups = xcalloc(2, sizeof(gid_t)),
        .group_count = 2,
        .access = {.kind = ACCESS_TOKEN, .scope = scope, .token = token, .expires_ms = expires_ms}};

    identity.groups[0] = 77;
    client_identity_take(client, &identity);
}

static void who_shows_a_token_is_its_user(void **state)
{
    struct stage stage;

    make_stage(&stage);
    assert_int_equal(stage.clients[0]->peer.uid, getuid());
    take(stage.clients[0], 1, SCOPE_SUBMIT, 0);
    assert_int_equal(stage.clients[0]->peer.uid, ADA);
    assert_string_equal(stage.clients[0]->user, "ada");
    assert_int_equal(stage.clients[0]->peer.group_count, 2);
    assert_int_equal(stage.clients[0]->peer.groups[0], 77);
    assert_true(stage.clients[0]->peer.is_ordinary);
    take(stage.clients[1], 1, SCOPE_ADMIN, 0);
    assert_false(stage.clients[1]->peer.is_ordinary);
    assert_int_equal(stage.clients[2]->peer.uid, getuid());
    finish_stage(&stage);
}

static void who_drops_their_user_is_nobody(void **state)
{
    struct stage stage;

    make_stage(&stage);
    client_identity_drop(stage.clients[0]);
    assert_int_equal(stage.clients[0]->peer.uid, -1);
    assert_int_equal(stage.clients[0]->peer.group_count, 0);
    assert_false(rights_is_known(&stage.clients[0]->peer));
    assert_int_equal(stage.clients[0]->access.kind, ACCESS_DROPPED);
    client_identity_drop(stage.clients[0]);
    take(stage.clients[0], 1, SCOPE_READ, 0);
    assert_int_equal(stage.clients[0]->peer.uid, ADA);
    finish_stage(&stage);
}

// A connection, and what its peer has not read, count as those of the token's user.
static void what_is_unread_counts_for_the_user_of_the_token(void **state)
{
    struct json_writer value = {0};
    struct client_account *peer, *ada;
    struct stage stage;
    size_t unread;

    make_stage(&stage);
    peer = stage.clients[0]->outgoing.account;
    json_write_string(&value, "unread");
    client_send_result(stage.clients[0], "1", &value);
    json_writer_finish(&value);
    unread = stage.clients[0]->outgoing.unread_bytes;
    assert_true(unread > 0);
    assert_int_equal(peer->unread_bytes, unread);
    assert_null(client_accounts_find(&stage.accounts, ADA));
    take(stage.clients[0], 1, SCOPE_READ, 0);
    ada = client_accounts_find(&stage.accounts, ADA);
    assert_non_null(ada);
    assert_ptr_equal(stage.clients[0]->outgoing.account, ada);
    assert_int_equal(peer->unread_bytes, 0);
    assert_int_equal(ada->unread_bytes, unread);
    assert_int_equal(peer->client_count, CLIENT_COUNT - 1);
    assert_int_equal(ada->client_count, 1);
    run_turns(&stage);
    assert_int_equal(ada->unread_bytes, 0);
    finish_stage(&stage);
}

static void a_user_has_room_for_so_many_connections(void **state)
{
    struct client_account *ada = NULL;
    struct stage stage;

    make_stage(&stage);
    assert_true(client_identity_has_room(stage.clients[0], ADA));
    for (int i = 0; i < CLIENT_ACCOUNT_CLIENTS - 1; i++)
        ada = client_accounts_join(&stage.accounts, ADA);
    assert_true(client_identity_has_room(stage.clients[0], ADA));
    take(stage.clients[1], 1, SCOPE_READ, 0);
    assert_false(client_identity_has_room(stage.clients[0], ADA));
    assert_true(client_identity_has_room(stage.clients[1], ADA)); // it is counted already
    for (int i = 0; i < CLIENT_ACCOUNT_CLIENTS - 1; i++)
        client_accounts_leave(&stage.accounts, ada);
    finish_stage(&stage);
}

static void assert_told(const struct stage *stage, int i, const char *expected)
{
    char text[512] = "";

    assert_true(recv(stage->ends[i], text, sizeof text - 1, MSG_DONTWAIT) > 0);
    assert_non_null(strstr(text, expected));
    assert_int_equal(recv(stage->ends[i], text, sizeof text, MSG_DONTWAIT), 0); // closed
}

static void a_revoke_ends_the_clients_of_that_token(void **state)
{
    struct stage stage;

    make_stage(&stage);
    take(stage.clients[0], 1, SCOPE_READ, 0);
    take(stage.clients[1], 2, SCOPE_READ, 0);
    client_identity_end_token(stage.clients[2], 1, "it was revoked");
    assert_int_equal(stage.clients[0]->access.kind, ACCESS_DROPPED); // of a message, too, that is still being read
    assert_int_equal(stage.clients[1]->access.kind, ACCESS_TOKEN);
    run_turns(&stage);
    assert_null(stage.clients[0]);
    assert_non_null(stage.clients[1]);
    assert_non_null(stage.clients[2]);
    assert_told(&stage, 0, "it was revoked");
    client_identity_end_token(stage.clients[2], 0, "it was revoked"); // of nobody
    run_turns(&stage);
    assert_non_null(stage.clients[2]);
    finish_stage(&stage);
}

static void time_ends_the_clients_of_a_token(void **state)
{
    struct stage stage;

    make_stage(&stage);
    take(stage.clients[0], 1, SCOPE_READ, 1000);
    take(stage.clients[1], 2, SCOPE_READ, 0);
    for (int i = 0; i < CLIENT_COUNT; i++)
        client_identity_check(stage.clients[i], 999);
    run_turns(&stage);
    assert_non_null(stage.clients[0]);
    for (int i = 0; i < CLIENT_COUNT; i++)
        client_identity_check(stage.clients[i], 1000);
    assert_int_equal(stage.clients[0]->access.kind, ACCESS_DROPPED);
    run_turns(&stage);
    assert_null(stage.clients[0]);
    assert_non_null(stage.clients[1]);
    assert_non_null(stage.clients[2]);
    assert_told(&stage, 0, "token: it has expired");
    finish_stage(&stage);
}

static void nothing_is_taken_while_a_client_closes(void **state)
{
    struct stage stage;

    make_stage(&stage);
    client_close(stage.clients[0]);
    take(stage.clients[0], 1, SCOPE_READ, 0);
    assert_null(client_accounts_find(&stage.accounts, ADA));
    run_turns(&stage);
    assert_null(stage.clients[0]);
    finish_stage(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_shows_a_token_is_its_user),
        cmocka_unit_test(who_drops_their_user_is_nobody),
        cmocka_unit_test(what_is_unread_counts_for_the_user_of_the_token),
        cmocka_unit_test(a_user_has_room_for_so_many_connections),
        cmocka_unit_test(a_revoke_ends_the_clients_of_that_token),
        cmocka_unit_test(time_ends_the_clients_of_a_token),
        cmocka_unit_test(nothing_is_taken_while_a_client_closes),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
