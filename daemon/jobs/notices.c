// SPDX-License-Identifier: Apache-2.0
#include "daemon/jobs/notices.h"

#include "core/base/alloc.h"
#include "core/base/log.h"
#include "core/json/json_write.h"
#include "daemon/farm/farm.h"
#include "daemon/jobs/job_view.h"
#include "daemon/settings/options.h"
#include "daemon/store/committer.h"
#include "daemon/store/store_reader.h"

#include <string.h>

// Ids grow over restarts, since each epoch is greater than those before.
enum { BODY_VERSION = 1, EPOCH_BITS = 30, RULE_LIMIT = 2 * JOB_NOTIFY_LIMIT, DROPS_OF_A_LINE = 1000 };

// Ops that are committed together: that of the change, and two a notice, for one that is dropped.
struct batch {
    struct store_op ops[1 + 2 * RULE_LIMIT];
    size_t count;
};

static const char *target_of(const struct job_notify_rule *rule)
{
    return rule->to ? rule->to : rule->webhook;
}

// Rules that want the event, of the job and of the settings, each target once.
static size_t find_rules(const struct farm *farm, const struct job_record *record, enum job_notify_event event,
                         const struct job_notify_rule *found[static RULE_LIMIT])
{
    const struct job_notify *sources[] = {&record->notify, &farm->options->notify};
    size_t count = 0;

    for (size_t source = 0; source < 2; source++)
        for (size_t i = 0; i < sources[source]->count; i++) {
            const struct job_notify_rule *rule = &sources[source]->rules[i];
            bool is_known = false;

            if (!(rule->on & 1U << event)) continue;
            for (size_t other = 0; other < count && !is_known; other++)
                is_known = strcmp(target_of(found[other]), target_of(rule)) == 0;
            if (!is_known) found[count++] = rule;
        }
    return count;
}

bool notices_are_wanted(const struct farm *farm, const struct job_record *record, enum job_notify_event event)
{
    const struct job_notify_rule *found[RULE_LIMIT];

    return find_rules(farm, record, event, found) > 0;
}

static char *format_body(const struct farm *farm, const struct notice *notice, int64_t id, int64_t made_ms)
{
    struct json_writer writer = {0};

    json_write_begin_object(&writer);
    json_write_integer_member(&writer, "version", BODY_VERSION);
    json_write_integer_member(&writer, "id", id);
    json_write_string_member(&writer, "farm", farm->id);
    json_write_string_member(&writer, "event", job_notify_event_names[notice->event]);
    json_write_number_member(&writer, "time", (double)made_ms / 1000);
    json_write_key(&writer, "job");
    json_write_begin_object(&writer);
    job_view_write_outline(farm, notice->record, notice->why, &writer);
    json_write_end_object(&writer);
    json_write_end_object(&writer);
    return writer.text;
}

static void note_drop(struct farm *farm, struct batch *batch, int64_t id)
{
    if (farm->notices.dropped % DROPS_OF_A_LINE == 1)
        log_warn("notices: too many wait for march-web to deliver them: the oldest are dropped (%lld so far)",
                 (long long)farm->notices.dropped);
    batch->ops[batch->count++] = (struct store_op){.kind = STORE_DROP_NOTICE, .notice.id = id};
}

static void add(struct farm *farm, const struct notice *notice, const struct job_notify_rule *rule, struct batch *batch)
{
    int64_t made_ms = farm_clock_ms(), id = farm->next_notice_id++, dropped;
    struct store_op op = {.kind = STORE_ADD_NOTICE,
                          .notice = {.id = id,
                                     .job = notice->record->id,
                                     .owner_uid = notice->record->owner_uid,
                                     .made_ms = made_ms,
                                     .event = xstrdup(job_notify_event_names[notice->event]),
                                     .target = xstrdup(target_of(rule)),
                                     .is_webhook = rule->webhook != NULL,
                                     .body = format_body(farm, notice, id, made_ms)}};

    batch->ops[batch->count++] = op;
    notice_list_add(&farm->notices, id, notice->record->owner_uid, &dropped);
    if (dropped) note_drop(farm, batch, dropped);
}

void notices_store_with(struct farm *farm, const struct notice *notice, struct store_op op)
{
    const struct job_notify_rule *rules[RULE_LIMIT];
    size_t count = find_rules(farm, notice->record, notice->event, rules);
    struct batch batch = {.count = 1};

    batch.ops[0] = op;
    for (size_t i = 0; i < count; i++)
        add(farm, notice, rules[i], &batch);
    committer_put(farm->committer, COMMIT_SILENT, batch.ops, batch.count, NULL, NULL);
}

void notices_store_end(struct farm *farm, struct job_record *record, struct store_op op)
{
    enum job_state state = queue_job_state(record->queued);
    const struct notice notice = {.record = record, .event = state == JOB_FAILED ? JOB_NOTIFY_FAILED : JOB_NOTIFY_DONE};
    bool is_told = record->is_end_told || (state != JOB_FAILED && state != JOB_SUCCEEDED);

    record->is_end_told = true;
    if (is_told)
        farm_store(farm, op);
    else
        notices_store_with(farm, &notice, op);
}

static bool on_notice(void *user, const struct store_notice *notice, struct error *error)
{
    struct farm *farm = user;
    int64_t dropped;

    (void)error;
    notice_list_add(&farm->notices, notice->id, notice->owner_uid, &dropped);
    if (farm->next_notice_id <= notice->id) farm->next_notice_id = notice->id + 1;
    return true;
}

static bool on_told(void *user, const struct store_told *told, struct error *error)
{
    struct job_record *record = job_table_find(&((struct farm *)user)->jobs, told->job);

    (void)error;
    if (!record || told->cause < 0 || told->cause >= NOTICE_CAUSE_COUNT) return true;
    record->told[told->cause] = (struct notice_told){.told_ms = told->told_ms, .is_on = told->is_on};
    return true;
}

bool notices_restore(struct farm *farm, struct error *error)
{
    farm->next_notice_id = (farm->epoch << EPOCH_BITS) + 1;
    return store_list_notices(farm->reader, on_notice, farm, error) &&
           store_read_told(farm->reader, on_told, farm, error);
}

struct store_op notices_drop(struct farm *farm, int64_t id)
{
    notice_list_remove(&farm->notices, id);
    return (struct store_op){.kind = STORE_DROP_NOTICE, .notice.id = id};
}
