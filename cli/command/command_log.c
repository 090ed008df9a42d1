// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "core/json/json_write.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static int64_t integer_of(const struct json_node *attempt, const char *key)
{
    struct json_node node = json_node_child(attempt, key);
    int64_t integer;

    return json_read_integer(&node, 0, INT64_C(1) << 52, &integer, NULL) ? integer : -1;
}

static const char *text_of(const struct json_node *attempt, const char *key)
{
    struct json_node node = json_node_child(attempt, key);
    const char *text;

    return json_read_string(&node, &text, NULL) ? text : "";
}

static void print_attempt(const struct json_node *attempt)
{
    struct json_node ended = json_node_child(attempt, "ended");
    const char *log = text_of(attempt, "log");
    char when[PRINT_TIME_SIZE];
    double seconds = -1;

    json_read_number(&ended, 0, 1e12, &seconds, NULL);
    print_format_time(seconds, when);
    printf("%s  frame %" PRId64 ", attempt %" PRId64 ", worker %" PRId64 ": %s\n", when, integer_of(attempt, "frame"),
           integer_of(attempt, "attempt"), integer_of(attempt, "worker"), text_of(attempt, "outcome"));
    while (*log) {
        size_t length = strcspn(log, "\n");

        printf("    %.*s\n", (int)length, log);
        log += length + (log[length] == '\n');
    }
}

enum exit_status command_log(const struct options *options, struct error *error)
{
    struct json_writer params = {0};
    struct json_node attempts;
    struct message reply;
    enum exit_status status;
    int64_t id;

    if (!options_parse_id(options->operands[0], &id, error)) return EXIT_STATUS_USAGE;
    json_write_begin_object(&params);
    json_write_integer_member(&params, "id", id);
    if (options->frame >= 0) json_write_integer_member(&params, "frame", options->frame);
    json_write_end_object(&params);
    status = daemon_call(options, "job.log", params.text, &reply, error);
    json_writer_finish(&params);
    if (status != EXIT_STATUS_DONE) return status;
    attempts = json_node_child(&reply.body, "attempts");
    if (options->json)
        print_json(&reply.body);
    else
        for (size_t i = json_node_count(&attempts); i > 0; i--) {
            struct json_node attempt = json_node_element(&attempts, i - 1);

            print_attempt(&attempt);
        }
    message_finish(&reply);
    return status;
}
