// Single calls to the daemon, each with a token; connections are kept for the next call with the same one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "web/farm/farm_connection.h"

#include <stddef.h>
#include <uv.h>

struct farm_call;
struct farm_calls;

struct farm_answer {
    enum farm_end end; // FARM_OPEN: it was answered
    const char *why;   // where it was not
    const char *line;  // one message, without its line feed; borrowed
    size_t length;
    const struct farm_identity *identity; // borrowed; NULL where it was not answered
};

typedef void farm_on_answer(void *user, const struct farm_answer *answer);

struct farm_calls *farm_calls_create(uv_loop_t *loop, const char *socket_path); // borrowed; outlive us
void farm_calls_destroy(struct farm_calls *calls); // no call may be open; connections close in the loop

// Sends `request` (a message with an id, which is answered by one) with the rights of `token`; `on_answer` follows,
// never from within. `request` NULL: nothing is sent, and the answer has only the identity; `token` NULL, too: it only
// tells that the daemon answers.
struct farm_call *farm_calls_begin(struct farm_calls *calls, const char *token, const char *request, size_t length,
                                   farm_on_answer *on_answer, void *user);
void farm_call_cancel(struct farm_call *call); // on_answer is not called
