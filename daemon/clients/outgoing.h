// Texts that wait to be written to one stream.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/clients/client_account.h"

#include <stdbool.h>
#include <stddef.h>

#include <uv.h>

struct outgoing_text;
struct shared_text;

// The zero value with a stream is empty.
struct outgoing {
    uv_stream_t *stream; // borrowed; its pending writes end before it is closed
    void (*on_written)(void *user, int status);
    void *user;
    struct client_account *account; // borrowed; NULL: none. Its sums have the bytes of this one, too.
    struct outgoing_text *texts;    // owned; what no write has begun with
    size_t count, capacity;
    size_t unread_bytes; // waiting or being written
    size_t event_bytes;  // of these: events
    int writes;          // under way
};

// What is unread counts there from here on; it has an account before.
void outgoing_change_account(struct outgoing *outgoing, struct client_account *account);
// Moves `text` in. The same text as the one before takes no further memory.
void outgoing_add(struct outgoing *outgoing, struct shared_text *text, bool is_event);
// Writes all that waits, in one write, unless one is under way; then, if `behind`, in one behind it. False: the stream
// fails.
bool outgoing_write(struct outgoing *outgoing, bool behind);
void outgoing_drop(struct outgoing *outgoing); // what no write has begun with
