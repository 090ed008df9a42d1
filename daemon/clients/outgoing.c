// SPDX-License-Identifier: Apache-2.0
#include "daemon/clients/outgoing.h"

#include "core/base/alloc.h"
#include "daemon/clients/shared_text.h"

#include <stdlib.h>

struct outgoing_text {
    struct shared_text *text; // held
    size_t times;             // to be written so often, one after another
    bool is_event;
};

struct outgoing_write {
    uv_write_t request;
    struct outgoing *outgoing;   // borrowed; a write ends before its stream is closed
    struct outgoing_text *texts; // owned
    size_t count;
};

static void on_written(uv_write_t *request, int status);

static void count(struct outgoing *outgoing, const struct outgoing_text *text, size_t times, bool is_added)
{
    size_t bytes = text->text->length * times * (is_added ? 1 : (size_t)-1);
    size_t event_bytes = text->is_event ? bytes : 0;

    outgoing->unread_bytes += bytes;
    outgoing->event_bytes += event_bytes;
    if (!outgoing->account) return;
    outgoing->account->unread_bytes += bytes;
    outgoing->account->event_bytes += event_bytes;
}

void outgoing_change_account(struct outgoing *outgoing, struct client_account *account)
{
    outgoing->account->unread_bytes -= outgoing->unread_bytes;
    outgoing->account->event_bytes -= outgoing->event_bytes;
    account->unread_bytes += outgoing->unread_bytes;
    account->event_bytes += outgoing->event_bytes;
    outgoing->account = account;
}

void outgoing_add(struct outgoing *outgoing, struct shared_text *text, bool is_event)
{
    struct outgoing_text *last = outgoing->count > 0 ? &outgoing->texts[outgoing->count - 1] : NULL;

    if (last && last->text == text) {
        last->times++;
        shared_text_release(text);
    } else {
        outgoing->texts = xgrow(outgoing->texts, &outgoing->capacity, outgoing->count + 1, sizeof *outgoing->texts);
        last = &outgoing->texts[outgoing->count++];
        *last = (struct outgoing_text){.text = text, .times = 1, .is_event = is_event};
    }
    count(outgoing, last, 1, true);
}

static void release(struct outgoing *outgoing, struct outgoing_text *texts, size_t text_count)
{
    for (size_t i = 0; i < text_count; i++) {
        count(outgoing, &texts[i], texts[i].times, false);
        shared_text_release(texts[i].text);
    }
    free(texts);
}

void outgoing_drop(struct outgoing *outgoing)
{
    release(outgoing, outgoing->texts, outgoing->count);
    outgoing->texts = NULL;
    outgoing->count = outgoing->capacity = 0;
}

static uv_buf_t *list_buffers(const struct outgoing *outgoing, unsigned *buffer_count)
{
    size_t total = 0, next = 0;
    uv_buf_t *buffers;

    for (size_t i = 0; i < outgoing->count; i++)
        total += outgoing->texts[i].times;
    buffers = xmalloc(total * sizeof *buffers);
    for (size_t i = 0; i < outgoing->count; i++)
        for (size_t times = 0; times < outgoing->texts[i].times; times++)
            buffers[next++] = uv_buf_init(outgoing->texts[i].text->bytes, (unsigned)outgoing->texts[i].text->length);
    *buffer_count = (unsigned)total;
    return buffers;
}

bool outgoing_write(struct outgoing *outgoing, bool behind)
{
    struct outgoing_write *write;
    uv_buf_t *buffers;
    unsigned buffer_count;
    int result;

    if (outgoing->count == 0 || (outgoing->writes > 0 && !behind)) return true;
    write = xmalloc(sizeof *write);
    buffers = list_buffers(outgoing, &buffer_count);
    write->outgoing = outgoing;
    write->texts = outgoing->texts;
    write->count = outgoing->count;
    outgoing->texts = NULL;
    outgoing->count = outgoing->capacity = 0;
    outgoing->writes++;
    result = uv_write(&write->request, outgoing->stream, buffers, buffer_count, on_written);
    free(buffers);
    if (result == 0) return true;
    outgoing->writes--;
    release(outgoing, write->texts, write->count);
    free(write);
    return false;
}

static void on_written(uv_write_t *request, int status)
{
    struct outgoing_write *write = (struct outgoing_write *)request;
    struct outgoing *outgoing = write->outgoing;

    release(outgoing, write->texts, write->count);
    free(write);
    outgoing->writes--;
    outgoing->on_written(outgoing->user, status);
}
