// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/answer.h"

#include "core/base/alloc.h"
#include "daemon/clients/client.h"

#include <stdlib.h>
#include <string.h>

struct answer {
    struct client *client; // held until the answer is sent
    char id[MESSAGE_ID_SIZE];
};

struct answer *answer_create(struct client *client, const char *id)
{
    struct answer *answer = xcalloc(1, sizeof *answer);

    answer->client = client;
    strncpy(answer->id, id, sizeof answer->id - 1);
    client_hold(client);
    return answer;
}

void answer_send_result(struct answer *answer, const struct json_writer *value)
{
    client_send_result(answer->client, answer->id, value);
    client_release(answer->client);
    free(answer);
}

void answer_send_error(struct answer *answer, enum message_code code, const char *text)
{
    client_send_error(answer->client, answer->id, code, text);
    client_release(answer->client);
    free(answer);
}
