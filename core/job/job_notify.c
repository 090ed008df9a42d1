// SPDX-License-Identifier: Apache-2.0
#include "core/job/job_notify.h"

#include "core/base/alloc.h"
#include "core/base/error.h"
#include "core/json/json_read.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

const char *const job_notify_event_names[] = {"done", "failed", "waiting", "missed", NULL};

bool job_notify_is_name(const char *text)
{
    if (!isalnum((unsigned char)*text) || strlen(text) > JOB_NOTIFY_NAME_LIMIT) return false;
    for (; *text; text++)
        if (!isalnum((unsigned char)*text) && !strchr("-._", *text)) return false;
    return true;
}

bool job_notify_is_webhook(const char *text)
{
    size_t scheme = strncmp(text, "https://", 8) == 0 ? 8 : strncmp(text, "http://", 7) == 0 ? 7 : 0;
    const char *host = text + scheme, *rest = host + strcspn(host, "/?#");

    if (scheme == 0 || !isalnum((unsigned char)*host) || strlen(text) > JOB_NOTIFY_WEBHOOK_LIMIT) return false;
    for (const char *byte = host; byte < rest; byte++)
        if (!isalnum((unsigned char)*byte) && !strchr("-._:", *byte)) return false;
    for (; *rest; rest++)
        if (*rest <= ' ' || *rest > '~') return false;
    return true;
}

static bool read_events(unsigned *on, const struct json_node *node, struct error *error)
{
    struct json_node name = {0};
    int choice;

    if (!json_check_array(node, 1, JOB_NOTIFY_EVENT_COUNT, error)) return false;
    while (json_node_next(node, &name)) {
        if (!json_read_enum(&name, job_notify_event_names, &choice, error)) return false;
        if (*on & 1U << choice) return json_fail(&name, error, "\"%s\" is there twice", job_notify_event_names[choice]);
        *on |= 1U << choice;
    }
    return true;
}

static bool read_target(struct job_notify_rule *rule, const struct json_node *to, const struct json_node *webhook,
                        struct error *error)
{
    const char *text;

    if (!json_node_is_absent(webhook)) {
        if (!json_read_string(webhook, &text, error)) return false;
        if (!job_notify_is_webhook(text))
            return json_fail_expected(
                webhook, error, "an address like \"https://HOST/PATH\" of up to 1000 bytes, without a user's name");
        rule->webhook = xstrdup(text);
        return true;
    }
    if (!json_read_string(to, &text, error)) return false;
    if (!job_notify_is_name(text))
        return json_fail_expected(to, error, "a target's name: 1 to 64 letters, digits and -._");
    rule->to = xstrdup(text);
    return true;
}

static bool read_rule(struct job_notify *notify, const struct json_node *node, struct error *error)
{
    static const char *const keys[] = {"on", "to", "webhook", NULL};
    struct job_notify_rule *rule = &notify->rules[notify->count++];
    struct json_node on = json_node_child(node, "on"), to = json_node_child(node, "to"),
                     webhook = json_node_child(node, "webhook");

    if (!json_check_object(node, error) || !json_check_keys(node, keys, error) || !read_events(&rule->on, &on, error))
        return false;
    if (json_node_is_absent(&to) == json_node_is_absent(&webhook))
        return json_fail(node, error, "expected one of \"to\" and \"webhook\"");
    return read_target(rule, &to, &webhook, error);
}

bool job_notify_from_json(struct job_notify *notify, const struct json_node *document, struct error *error)
{
    struct json_node node = json_node_child(document, "notify"), rule = {0};

    if (json_node_is_absent(&node)) return true;
    if (!json_check_array(&node, 0, JOB_NOTIFY_LIMIT, error)) return false;
    while (json_node_next(&node, &rule))
        if (!read_rule(notify, &rule, error)) return false;
    return true;
}

static bool parse_events(unsigned *on, char *names)
{
    for (char *name; (name = strsep(&names, ","));) {
        int event = 0;

        while (job_notify_event_names[event] && strcmp(job_notify_event_names[event], name) != 0)
            event++;
        if (!job_notify_event_names[event]) return false;
        *on |= 1U << event;
    }
    return true;
}

bool job_notify_parse(struct job_notify *notify, const char *text, struct error *error)
{
    char *name = xstrdup(text), *events = strchr(name, ':');
    unsigned on = 0;
    bool ok = false;

    if (events) *events++ = '\0';
    if (!events || !job_notify_is_name(name) || !parse_events(&on, events))
        error_set(error, "expected NAME:EVENT,EVENT with events of done, failed, waiting and missed, got \"%.200s\"",
                  text);
    else if (notify->count == JOB_NOTIFY_LIMIT)
        error_set(error, "expected at most %d of them", JOB_NOTIFY_LIMIT);
    else
        ok = true;
    if (ok) notify->rules[notify->count++] = (struct job_notify_rule){.on = on, .to = xstrdup(name)};
    free(name);
    return ok;
}

void job_notify_finish(struct job_notify *notify)
{
    for (size_t i = 0; i < notify->count; i++) {
        free(notify->rules[i].to);
        free(notify->rules[i].webhook);
    }
    *notify = (struct job_notify){0};
}
