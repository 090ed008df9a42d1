// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static void print_text(const char *name, const struct json_node *object, const char *key)
{
    struct json_node node = json_node_child(object, key);
    const char *text;

    if (json_node_type(&node) == JSON_STRING && json_read_string(&node, &text, NULL)) printf("%-12s %s\n", name, text);
}

static void print_texts(const char *name, const struct json_node *object, const char *key)
{
    struct json_node list = json_node_child(object, key), node = {0};
    const char *text;

    while (json_node_next(&list, &node))
        if (json_read_string(&node, &text, NULL)) printf("%-12s %s\n", name, text);
}

// Why output roots are away, each by its path.
static void print_trouble(const struct json_node *status)
{
    struct json_node roots = json_node_child(status, "roots"), root = {0};

    while (json_node_next(&roots, &root))
        print_text("", &root, "reason");
}

// "3 queued, 1 running": what there is none of is left out.
static void print_counts(const char *name, const struct json_node *object, const char *key)
{
    struct json_node counts = json_node_child(object, key), node = {0};
    const char *separator = "";
    int64_t count;

    printf("%-12s ", name);
    while (json_node_next(&counts, &node)) {
        if (!json_read_integer(&node, 0, INT64_MAX, &count, NULL) || count == 0) continue;
        printf("%s%" PRId64 " %s", separator, count, node.key);
        separator = ", ";
    }
    printf("%s\n", *separator ? "" : "none");
}

static double read_number(const struct json_node *object, const char *key)
{
    struct json_node node = json_node_child(object, key);
    double number = 0.0;

    return json_read_number(&node, 0.0, 1e18, &number, NULL) ? number : 0.0;
}

// "2140 up to 1 ms, 3 up to 5 ms": classes without a turn are left out.
static void print_turns(const struct json_node *status)
{
    struct json_node loop = json_node_child(status, "loop"), counts = json_node_child(&loop, "counts"), node = {0};
    struct json_node ends = json_node_child(&loop, "up_to_ms");
    const char *separator = "";

    if (json_node_is_absent(&loop)) return;
    printf("%-12s longest %.1f ms of processor time: ", "turns", read_number(&loop, "longest_ms"));
    while (json_node_next(&counts, &node)) {
        struct json_node end = json_node_element(&ends, node.index);
        int64_t count, end_ms = 0;

        if (!json_read_integer(&node, 0, INT64_MAX, &count, NULL) || count == 0) continue;
        if (json_read_integer(&end, 0, INT64_MAX, &end_ms, NULL))
            printf("%s%" PRId64 " up to %" PRId64 " ms", separator, count, end_ms);
        else
            printf("%s%" PRId64 " longer", separator, count);
        separator = ", ";
    }
    printf("\n");
}

static void print_drain(const struct json_node *status)
{
    struct json_node drain = json_node_child(status, "drain"), user = json_node_child(&drain, "user");
    char time[PRINT_TIME_SIZE];
    const char *name;

    if (json_node_type(&user) != JSON_STRING || !json_read_string(&user, &name, NULL)) return;
    print_format_time(read_number(&drain, "since"), time);
    printf("%-12s by %s since %s: no frame is begun until `march undrain` or a restart\n", "drained", name, time);
}

// Farms of one machine have none.
static void print_nodes(const struct json_node *status)
{
    struct json_node nodes = json_node_child(status, "nodes");

    if (read_number(&nodes, "up") + read_number(&nodes, "waiting") > 0) print_counts("nodes", status, "nodes");
}

static void print_status(const struct json_node *status)
{
    struct json_node store = json_node_child(status, "store");
    char time[PRINT_TIME_SIZE];

    print_text("version", status, "version");
    printf("%-12s %.0f\n", "pid", read_number(status, "pid"));
    print_format_time(read_number(status, "started"), time);
    printf("%-12s %s\n", "started", time);
    print_drain(status);
    print_counts("jobs", status, "jobs");
    print_counts("frames", status, "frames");
    printf("%-12s %.0f\n", "workers", read_number(status, "workers"));
    print_nodes(status);
    print_texts("output root", status, "output_roots");
    print_trouble(status);
    print_texts("input root", status, "input_roots");
    print_text("state", status, "state_folder");
    print_text("store", &store, "state");
    print_text("", &store, "reason");
    print_turns(status);
}

enum exit_status command_status(const struct options *options, struct error *error)
{
    struct message reply;
    enum exit_status status = daemon_call(options, "daemon.status", NULL, &reply, error);

    if (status != EXIT_STATUS_DONE) return status;
    if (options->json)
        print_json(&reply.body);
    else
        print_status(&reply.body);
    message_finish(&reply);
    return status;
}
