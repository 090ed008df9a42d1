// An answer that is sent after its request was handled. It keeps the client alive until then.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message.h"

struct answer;
struct client;
struct json_writer;

// The answer to the request `id` (copied). An empty id means that the client wants no answer: nothing is sent.
struct answer *answer_create(struct client *client, const char *id);
// Each answer is sent exactly once, by one of these, which frees it.
void answer_send_result(struct answer *answer, const struct json_writer *value);
void answer_send_error(struct answer *answer, enum message_code code, const char *text);
