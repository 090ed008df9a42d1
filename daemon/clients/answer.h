// An answer that a client gets later: it lives until it is sent, and keeps the client alive.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message.h"

struct answer;
struct client;
struct json_writer;

// The answer to the request `id`, which is copied; empty: none is wanted, and none is sent.
struct answer *answer_create(struct client *client, const char *id);
// Each answer is sent once, which frees it.
void answer_send_result(struct answer *answer, const struct json_writer *value);
void answer_send_error(struct answer *answer, enum message_code code, const char *text);
