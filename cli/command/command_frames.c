// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/farm/job_states.h"
#include "cli/farm/plan_beyond.h"
#include "cli/peer/connection.h"
#include "cli/program/options.h"
#include "core/base/alloc.h"
#include "core/json/json_read.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PAGE_SIZE = 10000 };

static const char *text_of(const struct json_node *frame, const char *key, const char *otherwise)
{
    struct json_node node = json_node_child(frame, key);
    const char *text;

    return json_read_string(&node, &text, NULL) ? text : otherwise;
}

static double number_of(const struct json_node *frame, const char *key)
{
    struct json_node node = json_node_child(frame, key);
    double number;

    return json_read_number(&node, 0, 1e300, &number, NULL) ? number : -1;
}

static void print_seconds(double seconds)
{
    if (seconds >= 0)
        printf("  %8.3f", seconds);
    else
        printf("  %8s", "-");
}

// The estimate of a frame's error and the bound that it is below with a confidence of 95 %.
static void print_audit(const struct json_node *frame)
{
    double error = number_of(frame, "measured_error"), error95 = number_of(frame, "error95");
    char text[40] = "-";

    if (error > 0 || (error == 0 && !(error95 > 0)))
        snprintf(text, sizeof text, "%.2g / %.2g", 100 * error, 100 * error95);
    else if (error == 0)
        snprintf(text, sizeof text, "at most %.2g", 100 * error95); // chance made the estimate vanish
    printf("  %15s", text);
}

// The file, why there is none, or what is done to it.
static void print_end(const struct json_node *frame)
{
    double progress = number_of(frame, "phase_progress");
    const char *phase = text_of(frame, "phase", NULL), *why = text_of(frame, "error", NULL);
    const char *node = text_of(frame, "node", NULL);

    if (phase && progress > 0)
        printf("  %s %.0f %%", phase, 100 * progress);
    else
        printf("  %s", phase ? phase : why ? why : text_of(frame, "path", node ? "in hand" : "-"));
    printf("%s%s\n", node ? " on " : "", node ? node : "");
}

static void print_share(const struct json_node *frame, const char *key)
{
    double share = number_of(frame, key);

    if (share >= 0)
        printf("  %8.3g", 100 * share);
    else
        printf("  %8s", "-");
}

// What the orders that are modelled leave out, as the frame's plan has it: a column where some plan knows it.
static void print_beyond(const struct json_node *frame, const struct plan_beyond *plans)
{
    const struct job_beyond *beyond = plan_beyond_find(plans, (int64_t)number_of(frame, "plan"));
    char error[JOB_BEYOND_PERCENT_SIZE], bound[JOB_BEYOND_PERCENT_SIZE], both[40] = "-";

    if (plans->count == 0) return;
    if (beyond) {
        job_beyond_percent(beyond->error, error);
        job_beyond_percent(beyond->error95, bound);
        snprintf(both, sizeof both, "%s / %s", error, bound);
    }
    printf("  %15s", both);
}

// Columns have fixed widths, so that each page is printed before the next is requested.
static void print_frame(const struct json_node *frame, const struct plan_beyond *plans)
{
    double size = number_of(frame, "size_bytes");

    printf("%8.0f  %-9s  %3.0f", number_of(frame, "frame"), text_of(frame, "state", "?"), number_of(frame, "attempts"));
    print_seconds(number_of(frame, "render_s"));
    print_seconds(number_of(frame, "encode_s"));
    if (size >= 0)
        printf("  %11.0f", size);
    else
        printf("  %11s", "-");
    printf("  %-13s", text_of(frame, "method", "-"));
    print_audit(frame);
    print_share(frame, "cut_share");
    print_share(frame, "traced");
    print_beyond(frame, plans);
    print_end(frame);
}

// As the daemon has it, and with what its plan leaves out.
static void print_json(const struct json_node *frame, const struct plan_beyond *plans)
{
    const struct job_beyond *beyond = plan_beyond_find(plans, (int64_t)number_of(frame, "plan"));
    char *text = json_node_format(frame);
    struct json_writer member = {0};

    if (beyond) job_beyond_write(beyond, &member);
    if (member.text)
        printf("%.*s,%s}", (int)strlen(text) - 1, text, member.text);
    else
        printf("%s", text);
    json_writer_finish(&member);
    free(text);
}

static void print_page(const struct options *options, const struct json_node *frames, const struct plan_beyond *plans,
                       bool is_first)
{
    struct json_node frame = {0};

    while (json_node_next(frames, &frame)) {
        if (options->json) {
            printf("%s", is_first ? "" : ",");
            print_json(&frame, plans);
            is_first = false;
        } else {
            print_frame(&frame, plans);
        }
    }
}

// `cursor` NULL: the first page.
static char *format_params(const struct options *options, int64_t id, const char *cursor)
{
    struct json_writer params = {0};

    json_write_begin_object(&params);
    json_write_integer_member(&params, "id", id);
    job_states_write(&params, options->state);
    if (options->range) json_write_string_member(&params, "range", options->range);
    if (cursor) json_write_string_member(&params, "cursor", cursor);
    json_write_integer_member(&params, "limit", PAGE_SIZE);
    json_write_end_object(&params);
    return params.text;
}

static void print_titles(const struct options *options, const struct plan_beyond *plans)
{
    if (options->json) {
        printf("{\"frames\":[");
        return;
    }
    printf("%8s  %-9s  %3s  %8s  %8s  %11s  %-13s  %15s  %8s  %8s", "FRAME", "STATE", "TRY", "RENDER S", "ENCODE S",
           "BYTES", "METHOD", "AUDIT % / 95 %", "CUT %", "TRACED %");
    if (plans->count > 0) printf("  %15s", "BEYOND % / 95 %");
    printf("  FILE, FAILURE OR PHASE\n");
}

struct listing {
    const struct options *options;
    struct connection *connection;
    int64_t id;
    struct plan_beyond plans;
    char *cursor;  // owned; NULL: the first page, and after the last one
    int64_t count; // frames that were printed
};

static enum exit_status print_next_page(struct listing *listing, struct error *error)
{
    char *params = format_params(listing->options, listing->id, listing->cursor);
    bool ok, is_first = !listing->cursor;
    struct json_node frames, next;
    struct message reply;
    const char *text;

    ok = connection_call(listing->connection, "job.frames", params, &reply, error);
    free(params);
    free(listing->cursor);
    listing->cursor = NULL;
    if (!ok) return connection_failure(listing->connection);
    if (is_first) print_titles(listing->options, &listing->plans);
    frames = json_node_child(&reply.body, "frames");
    next = json_node_child(&reply.body, "next");
    print_page(listing->options, &frames, &listing->plans, listing->count == 0);
    listing->count += (int64_t)json_node_count(&frames);
    if (json_read_string(&next, &text, NULL)) listing->cursor = xstrdup(text);
    message_finish(&reply);
    return EXIT_STATUS_DONE;
}

static enum exit_status print_frames(struct listing *listing, struct error *error)
{
    bool is_json = listing->options->json;
    enum exit_status status;

    plan_beyond_ask(&listing->plans, listing->connection, listing->id);
    do
        status = print_next_page(listing, error);
    while (status == EXIT_STATUS_DONE && listing->cursor);
    if (status == EXIT_STATUS_DONE && is_json) printf("],\"next\":null,\"total\":%" PRId64 "}\n", listing->count);
    plan_beyond_finish(&listing->plans);
    return status;
}

enum exit_status command_frames(const struct options *options, struct error *error)
{
    struct listing listing = {.options = options};
    enum exit_status status;

    if (!options_parse_id(options->operands[0], &listing.id, error)) return EXIT_STATUS_USAGE;
    listing.connection = daemon_call_connect(options, &status, error);
    if (!listing.connection) return status;
    status = print_frames(&listing, error);
    connection_close(listing.connection);
    return status;
}
