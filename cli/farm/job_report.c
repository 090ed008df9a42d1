// SPDX-License-Identifier: Apache-2.0
#include "cli/farm/job_report.h"

#include "cli/terminal/progress.h"
#include "core/base/alloc.h"
#include "core/json/json_read.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static char *read_text(const struct json_node *job, const char *key)
{
    struct json_node node = json_node_child(job, key);
    const char *text;

    return json_read_string(&node, &text, NULL) ? xstrdup(text) : NULL;
}

static double read_number(const struct json_node *job, const char *key)
{
    struct json_node node = json_node_child(job, key);
    double number;

    return json_read_number(&node, 0, HUGE_VAL, &number, NULL) ? number : -1;
}

static int64_t read_count(const struct json_node *job, const char *key)
{
    struct json_node node = json_node_child(job, key);
    int64_t count;

    return json_read_integer(&node, 0, INT64_C(1) << 52, &count, NULL) ? count : 0;
}

// NULL: none.
static char *read_tags(const struct json_node *job)
{
    struct json_node tags = json_node_child(job, "tags"), tag = {0};
    char *line = NULL;

    while (json_node_next(&tags, &tag)) {
        const char *text;
        char *longer;

        if (!json_read_string(&tag, &text, NULL)) continue;
        longer = line ? xasprintf("%s, %s", line, text) : xstrdup(text);
        free(line);
        line = longer;
    }
    return line;
}

bool job_report_read(struct job_report *report, const struct json_node *node, struct error *error)
{
    struct json_node id = json_node_child(node, "id"), state = json_node_child(node, "state");
    struct json_node draft = json_node_child(node, "draft");
    const char *text;

    memset(report, 0, sizeof *report);
    if (!json_read_integer(&id, 1, INT64_C(1) << 52, &report->id, error)) return false;
    if (!json_read_string(&state, &text, error)) return false;
    report->state = xstrdup(text);
    report->name = read_text(node, "name");
    report->owner = read_text(node, "owner");
    report->range = read_text(node, "range");
    report->output = read_text(node, "output");
    report->reason = read_text(node, "reason");
    report->phase = read_text(node, "phase");
    report->comment = read_text(node, "comment");
    report->pool = read_text(node, "pool");
    report->tags = read_tags(node);
    report->label = xasprintf("#%lld %s", (long long)report->id, report->name ? report->name : "");
    report->priority = read_count(node, "priority");
    report->frames = read_count(node, "frames");
    report->queued = read_count(node, "queued");
    report->running = read_count(node, "running");
    report->succeeded = read_count(node, "succeeded");
    report->failed = read_count(node, "failed");
    report->canceled = read_count(node, "canceled");
    report->skipped = read_count(node, "skipped");
    report->missed = read_count(node, "missed");
    report->submitted = read_number(node, "submitted");
    report->started = read_number(node, "started");
    report->finished = read_number(node, "finished");
    report->seconds_per_frame = read_number(node, "seconds_per_frame");
    json_read_bool(&draft, &report->is_draft, NULL);
    report->eta_s = read_number(node, "eta_s");
    report->phase_progress = read_number(node, "phase_progress");
    return true;
}

void job_report_finish(struct job_report *report)
{
    free(report->name);
    free(report->state);
    free(report->owner);
    free(report->range);
    free(report->output);
    free(report->reason);
    free(report->phase);
    free(report->comment);
    free(report->pool);
    free(report->tags);
    free(report->label);
    memset(report, 0, sizeof *report);
}

bool job_report_has_ended(const struct job_report *report)
{
    return strcmp(report->state, "succeeded") == 0 || strcmp(report->state, "failed") == 0 ||
           strcmp(report->state, "canceled") == 0;
}

bool job_report_is_next(const struct job_report *report)
{
    static const char reason[] = "waits for a "; // a free worker, or one that is being started

    return report->reason && strncmp(report->reason, reason, strlen(reason)) == 0;
}

enum exit_status job_report_status(const struct job_report *report)
{
    return strcmp(report->state, "succeeded") == 0 && report->missed == 0 ? EXIT_STATUS_DONE : EXIT_STATUS_FAILED;
}

void job_report_fill_progress(const struct job_report *report, struct progress *progress)
{
    *progress = (struct progress){.label = report->label,
                                  .state = report->state,
                                  .total = report->frames,
                                  .done = report->succeeded + report->skipped,
                                  .failed = report->failed + report->canceled,
                                  .seconds_per_frame = report->seconds_per_frame,
                                  .eta_s = report->eta_s,
                                  .reason = report->reason,
                                  .phase = report->phase,
                                  .phase_progress = report->phase_progress};
}
