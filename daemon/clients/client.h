// One client connection: splits bytes into messages, sends answers in any order, slows a client that floods.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message.h"
#include "core/wire/message_stream.h"
#include "daemon/clients/outgoing.h"
#include "daemon/loop/loop_turns.h"
#include "daemon/users/access.h"
#include "daemon/users/rights.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <uv.h>

struct client;
struct client_accounts;
struct json_writer;
struct memory_return;
struct shared_text;
struct work_desk;

// What clients share. Borrowed while one lives.
struct client_host {
    uv_loop_t *loop;
    struct loop_turns *turns;     // messages are handled one by one, and clients take turns
    struct work_desk *desk;       // where long messages are read
    struct memory_return *memory; // told of what a client leaves
    struct client_accounts *accounts;
    // The message is a request or a notification; its root may be taken out of it.
    void (*on_message)(void *user, struct client *client, struct message *message);
    void (*on_closed)(void *user, struct client *client); // it is freed next: nothing may be sent
    void *user;
};

// Bytes of a line that is read on the loop; a longer one is read in a thread.
enum { CLIENT_SHORT_LINE = 64 * 1024 };

struct client {
    uv_pipe_t pipe;
    const struct client_host *host;
    struct loop_task task; // sends what waits, handles one message
    struct message_stream stream;
    struct outgoing outgoing; // what is not read by the peer, and the account of its user
    size_t stuck_bytes;       // of the socket's queue, when it was looked at last
    int stuck_checks;         // in a row that found the same bytes there
    struct rights_peer peer;  // as the kernel named it at the time of the connection; or the user of a token
    gid_t *groups;            // owned; the peer's
    char *user;               // owned; the peer's user name, or its number
    struct access access;     // what it may ask for (client_identity.h)
    size_t pending_answers;   // deferred answers that were not sent yet
    bool has_place;           // for a long line; see client_account.h
    size_t stalled_bytes;     // received of that line, when it was looked at last
    int stalled_checks;       // in a row that found as many
    bool is_decoding;         // a long message is read in a thread: the next one waits
    bool is_reading;
    bool has_ended;  // the peer closed its sending side
    bool is_ignored; // the daemon reads no more messages from it
    bool is_closing, is_closed;
    uv_shutdown_t shutdown;
    struct client *next, *previous; // on the listener's list
};

// The client of a connection that was accepted, whose descriptor it takes; NULL when the system refuses. It frees
// itself after it is closed. It reads nothing before client_start.
struct client *client_create(const struct client_host *host, int fd);
void client_start(struct client *client);
void client_close(struct client *client); // at once; legal twice
// Sends the error, reads no messages, and closes.
void client_refuse(struct client *client, enum message_code code, const char *why);
void client_end(struct client *client); // sends what waits, and closes; legal twice
// Its connection and what it has not read count as the user's from here on.
void client_change_account(struct client *client, int64_t uid);
// Reads no more messages. Deferred answers and events are still sent.
void client_stop_reading(struct client *client);
// To be called every few seconds. Where messages of the user wait because too much is unread, a client that has read
// nothing for half a minute is closed; so is one that has sent nothing more of a long line, while its user's places for
// those are taken.
void client_check_stuck(struct client *client);

// All do nothing while the client is closing.
void client_send_event(struct client *client, struct shared_text *event); // holds the text until it is read
// The answer to the request `id`, whose value is taken out of the writer. Nothing is sent when `id` is empty: the
// client wants no answer.
void client_send_result(struct client *client, const char *id, struct json_writer *value);
void client_send_error(struct client *client, const char *id, enum message_code code, const char *text);

// For an answer that comes later: the client lives at least until client_release, which handles no message itself. A
// client with CLIENT_PENDING_LIMIT pending answers is not read from. `answers` is how many it counts as: one that may
// be long counts as all that there may be.
enum { CLIENT_PENDING_LIMIT = 16 };
void client_hold(struct client *client, size_t answers);
void client_release(struct client *client, size_t answers);
