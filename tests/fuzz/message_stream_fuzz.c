// Bytes that arrive in pieces of any size give the same lines as all at once, and every line decodes or is refused.
// SPDX-License-Identifier: Apache-2.0
#include "core/wire/message_stream.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { LINE_LIMIT = 4096 };

static void require(bool condition)
{
    if (!condition) abort();
}

// A decoded message is the same after it is encoded and decoded again.
static void check_round_trip(const struct message *message)
{
    struct json_writer writer = {0};
    struct message again;
    enum message_code code;
    char *body = json_node_format(&message->body);

    if (message->kind == MESSAGE_RESULT)
        message_begin_result(&writer, message->id);
    else
        message_begin_notification(&writer, message->method);
    json_write_raw(&writer, body, strlen(body));
    message_end(&writer);
    require(message_decode(&again, writer.text, writer.length, &code, NULL));
    if (message->kind == MESSAGE_RESULT)
        require(strcmp(again.id, message->id) == 0);
    else
        require(strcmp(again.method, message->method) == 0);
    message_finish(&again);
    json_writer_finish(&writer);
    free(body);
}

static void decode(const char *line, size_t length)
{
    struct message message;
    enum message_code code;
    struct error error = {0};

    if (message_decode(&message, line, length, &code, &error)) {
        if (message.kind != MESSAGE_ERROR && !json_node_is_absent(&message.body)) check_round_trip(&message);
    } else {
        require(error.message[0] != '\0' && !message.root);
        require(code == MESSAGE_CODE_PARSE || code == MESSAGE_CODE_INVALID);
    }
    message_finish(&message);
}

// Feeds the next piece, whose size the bytes themselves choose.
static size_t feed_piece(struct message_stream *stream, const uint8_t *bytes, size_t size, size_t at)
{
    size_t piece = 1 + bytes[at] % 64;
    size_t room;
    char *place = message_stream_reserve(stream, &room);

    if (piece > size - at) piece = size - at;
    require(room >= 1);
    if (piece > room) piece = room;
    memcpy(place, bytes + at, piece);
    message_stream_commit(stream, piece);
    return at + piece;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    struct message_stream whole = {.limit_bytes = LINE_LIMIT}, pieces = {.limit_bytes = LINE_LIMIT};
    struct error error = {0};
    size_t at = 0;

    message_stream_append(&whole, (const char *)bytes, size);
    for (;;) {
        size_t length, expected_length;
        const char *line = message_stream_next(&pieces, &length, &error);

        if (!line && !error.message[0] && at < size) {
            at = feed_piece(&pieces, bytes, size, at);
            continue;
        }
        struct error expected_error = {0};
        const char *expected = message_stream_next(&whole, &expected_length, &expected_error);

        require(!line == !expected && !error.message[0] == !expected_error.message[0]);
        if (!line) break;
        require(length == expected_length && length <= LINE_LIMIT && memcmp(line, expected, length) == 0);
        decode(line, length);
    }
    message_stream_finish(&whole);
    message_stream_finish(&pieces);
    return 0;
}
