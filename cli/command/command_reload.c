// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"

#include <stdio.h>

// "workers, threads" after `what`; `none` where there are no names.
static void print_names(const struct json_node *result, const char *key, const char *what, const char *none)
{
    struct json_node list = json_node_child(result, key), node = {0};
    const char *name, *before = what;

    while (json_node_next(&list, &node)) {
        if (!json_read_string(&node, &name, NULL)) continue;
        printf("%s%s", before, name);
        before = ", ";
    }
    if (before != what)
        printf("\n");
    else if (none)
        printf("%s\n", none);
}

enum exit_status command_reload(const struct options *options, struct error *error)
{
    struct message reply;
    enum exit_status status = daemon_call(options, "daemon.reload", NULL, &reply, error);

    if (status != EXIT_STATUS_DONE) return status;
    if (options->json) {
        print_json(&reply.body);
    } else {
        print_names(&reply.body, "changed", "settings: changed: ", "settings: read again, none changed");
        print_names(&reply.body, "restart", "settings: changed, but need a restart: ", NULL);
    }
    message_finish(&reply);
    return status;
}
