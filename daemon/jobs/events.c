// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/events.h"

#include "core/base/alloc.h"
#include "core/json/json_write.h"
#include "core/wire/message.h"
#include "daemon/clients/client.h"
#include "daemon/clients/shared_text.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/job_etas.h"
#include "daemon/jobs/job_view.h"
#include "daemon/loop/loop_turns.h"
#include "daemon/workers/worker_pool.h"

#include <stddef.h>
#include <stdlib.h>

enum { SUBSCRIPTIONS_LIMIT = 64, INTERVAL_MS = 250 };

struct subscription {
    struct client *client; // borrowed; events_forget comes before it is freed
    int64_t job;           // 0: all jobs
    bool wants_frames;
};

struct events {
    struct farm *farm;                  // borrowed; outlives us
    uv_timer_t timer;                   // active while changed counts wait to be sent
    struct subscription *subscriptions; // owned
    size_t count, capacity;
    size_t frame_count;          // of the subscriptions: those that want events of frames
    struct job_record **changed; // owned; records with is_changed
    size_t changed_count, changed_capacity;
    struct loop_task sending_task; // sends the events of those below, one in a step
    struct job_record **sending;   // owned; likewise, from `sent` on; NULL: removed
    size_t sending_count, sending_capacity, sent;
    struct job_etas sending_etas;
    struct json_writer writer; // of one event
};

static void on_interval(uv_timer_t *timer);
static bool on_sending_step(struct loop_task *task);

struct events *events_create(struct farm *farm)
{
    struct events *events = xcalloc(1, sizeof *events);

    events->farm = farm;
    events->sending_task.step = on_sending_step;
    uv_timer_init(farm->loop, &events->timer);
    events->timer.data = events;
    return events;
}

void events_close(struct events *events)
{
    uv_close((uv_handle_t *)&events->timer, NULL);
}

void events_destroy(struct events *events)
{
    if (!events) return;
    free(events->subscriptions);
    free(events->changed);
    free(events->sending);
    job_etas_finish(&events->sending_etas);
    json_writer_finish(&events->writer);
    free(events);
}

bool events_subscribe(struct events *events, struct client *client, int64_t job, bool wants_frames)
{
    size_t count = 0;

    for (size_t i = 0; i < events->count; i++)
        if (events->subscriptions[i].client == client) count++;
    if (count == SUBSCRIPTIONS_LIMIT) return false;
    events->subscriptions =
        xgrow(events->subscriptions, &events->capacity, events->count + 1, sizeof events->subscriptions[0]);
    events->subscriptions[events->count++] =
        (struct subscription){.client = client, .job = job, .wants_frames = wants_frames};
    events->frame_count += wants_frames;
    return true;
}

// `job` negative: whatever they are about.
static void remove_subscriptions(struct events *events, const struct client *client, int64_t job)
{
    size_t kept = 0;

    for (size_t i = 0; i < events->count; i++) {
        const struct subscription *subscription = &events->subscriptions[i];

        if (subscription->client != client || (job >= 0 && subscription->job != job))
            events->subscriptions[kept++] = *subscription;
        else
            events->frame_count -= subscription->wants_frames;
    }
    events->count = kept;
}

void events_unsubscribe(struct events *events, const struct client *client, int64_t job)
{
    remove_subscriptions(events, client, job);
}

void events_forget(struct events *events, const struct client *client)
{
    remove_subscriptions(events, client, -1);
}

// Events of frames are many, and most who listen want none.
static bool is_frame_wanted(const struct events *events, int64_t job)
{
    for (size_t i = 0; i < events->count && events->frame_count > 0; i++) {
        const struct subscription *subscription = &events->subscriptions[i];

        if (subscription->wants_frames && (!subscription->job || subscription->job == job)) return true;
    }
    return false;
}

static struct json_writer *begin_event(struct events *events, const char *type)
{
    message_begin_notification(&events->writer, "event");
    json_write_begin_object(&events->writer);
    json_write_string_member(&events->writer, "type", type);
    return &events->writer;
}

// `job` 0: to all subscribers, who share one text. client_close only begins the end of a client, so the list does not
// change here.
static void end_event(struct events *events, int64_t job, bool is_frame)
{
    struct shared_text *text;

    json_write_end_object(&events->writer);
    message_end(&events->writer);
    text = shared_text_create(&events->writer);
    for (size_t i = 0; i < events->count; i++) {
        const struct subscription *subscription = &events->subscriptions[i];

        if (job && subscription->job && subscription->job != job) continue;
        if (is_frame && !subscription->wants_frames) continue;
        client_send_event(subscription->client, text);
    }
    shared_text_release(text);
}

static void send_job(struct events *events, struct job_etas *etas, struct job_record *record)
{
    struct json_writer *writer;

    if (events->count == 0) return;
    writer = begin_event(events, "job");
    json_write_key(writer, "job");
    job_view_write(events->farm, etas, record, writer);
    end_event(events, record->id, false);
}

void events_note_job(struct events *events, struct job_record *record)
{
    enum job_state state = queue_job_state(record->queued);

    if (state != record->sent_state) {
        struct job_etas etas = {0};

        record->sent_state = state;
        send_job(events, &etas, record);
        job_etas_finish(&etas);
        return;
    }
    if (record->is_changed || events->count == 0) return;
    record->is_changed = true;
    events->changed =
        xgrow(events->changed, &events->changed_capacity, events->changed_count + 1, sizeof(struct job_record *));
    events->changed[events->changed_count++] = record;
    if (!uv_is_active((uv_handle_t *)&events->timer)) uv_timer_start(&events->timer, on_interval, INTERVAL_MS, 0);
}

static void on_interval(uv_timer_t *timer)
{
    struct events *events = timer->data;

    struct job_record **emptied = events->sending;
    size_t capacity = events->sending_capacity;

    if (events->sending_count > 0) {
        uv_timer_start(&events->timer, on_interval, INTERVAL_MS, 0);
        return;
    }
    events->sending = events->changed;
    events->sending_count = events->changed_count;
    events->sending_capacity = events->changed_capacity;
    events->changed = emptied;
    events->changed_count = 0;
    events->changed_capacity = capacity;
    events->sent = 0;
    loop_turns_put(events->farm->turns, &events->sending_task);
}

// A job's event may be long, and thousands may change at once.
static bool on_sending_step(struct loop_task *task)
{
    struct events *events = (struct events *)((char *)task - offsetof(struct events, sending_task));
    struct job_record *record = events->sent < events->sending_count ? events->sending[events->sent++] : NULL;

    if (record) record->is_changed = false;
    if (record) send_job(events, &events->sending_etas, record);
    if (events->sent < events->sending_count) return true;
    job_etas_finish(&events->sending_etas);
    events->sending_count = 0;
    return false;
}

void events_note_reasons(struct events *events)
{
    for (size_t i = 0; i < events->farm->jobs.count; i++) {
        struct job_record *record = events->farm->jobs.records[i];

        if (queue_job_is_live(record->queued)) events_note_job(events, record);
    }
}

static void forget_change(struct events *events, const struct job_record *record)
{
    size_t kept = 0;

    for (size_t i = 0; i < events->changed_count; i++)
        if (events->changed[i] != record) events->changed[kept++] = events->changed[i];
    events->changed_count = kept;
    for (size_t i = events->sent; i < events->sending_count; i++)
        if (events->sending[i] == record) events->sending[i] = NULL;
}

void events_send_deleted(struct events *events, struct job_record *record)
{
    struct json_writer *writer;

    forget_change(events, record);
    if (events->count == 0) return;
    writer = begin_event(events, "deleted");
    json_write_integer_member(writer, "id", record->id);
    end_event(events, record->id, false);
}

void events_send_frame(struct events *events, const struct queue_ticket *ticket, enum frame_state state,
                       const char *error)
{
    struct json_writer *writer;

    if (!is_frame_wanted(events, ticket->job)) return;
    writer = begin_event(events, "frame");
    json_write_integer_member(writer, "id", ticket->job);
    json_write_integer_member(writer, "frame", ticket->frame);
    json_write_string_member(writer, "state", frame_state_name(state));
    json_write_integer_member(writer, "attempt", ticket->attempt);
    json_write_string_member(writer, "error", error);
    end_event(events, ticket->job, true);
}

void events_send_phase(struct events *events, const struct in_flight_frame *frame)
{
    struct json_writer *writer;

    if (!is_frame_wanted(events, frame->ticket.job)) return;
    writer = begin_event(events, "phase");
    json_write_integer_member(writer, "id", frame->ticket.job);
    json_write_integer_member(writer, "frame", frame->ticket.frame);
    json_write_integer_member(writer, "attempt", frame->ticket.attempt);
    job_view_write_phase(frame->phase, frame->phase_progress, writer);
    end_event(events, frame->ticket.job, true);
}

void events_send_worker(struct events *events, int slot_index)
{
    struct json_writer *writer;

    if (events->count == 0) return;
    writer = begin_event(events, "worker");
    json_write_key(writer, "worker");
    worker_pool_write_slot(events->farm->pool, slot_index, writer);
    end_event(events, 0, false);
}
