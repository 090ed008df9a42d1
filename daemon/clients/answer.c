// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/answer.h"

#include "core/base/alloc.h"
#include "daemon/clients/client.h"

#include <stdlib.h>
#include <string.h>

struct answer {
    struct client *client; // held until the answer is sent
    size_t counts;         // as so many answers
    char id[MESSAGE_ID_SIZE];
};

struct answer *answer_create(struct client *client, const char *id, bool is_long)
{
    struct answer *answer = xcalloc(1, sizeof *answer);

    answer->client = client;
    answer->counts = is_long ? CLIENT_PENDING_LIMIT : 1;
    strncpy(answer->id, id, sizeof answer->id - 1);
    client_hold(client, answer->counts);
    return answer;
}

static void end(struct answer *answer)
{
    client_release(answer->client, answer->counts);
    free(answer);
}

void answer_send_result(struct answer *answer, struct json_writer *value)
{
    client_send_result(answer->client, answer->id, value);
    end(answer);
}

void answer_send_error(struct answer *answer, enum message_code code, const char *text)
{
    client_send_error(answer->client, answer->id, code, text);
    end(answer);
}
