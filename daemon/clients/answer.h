// An answer that is sent after its request was handled. It keeps the client alive until then.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/wire/message.h"

#include <stdbool.h>

struct answer;
struct client;
struct json_writer;

// The answer to the request `id` (copied). An empty id means that the client wants no answer: nothing is sent. While an
// answer that may be long is due, no other message of the client is handled, so that long ones do not pile up.
struct answer *answer_create(struct client *client, const char *id, bool is_long);
// Each answer is sent exactly once, by one of these, which frees it. The value is taken out of the writer.
void answer_send_result(struct answer *answer, struct json_writer *value);
void answer_send_error(struct answer *answer, enum message_code code, const char *text);
