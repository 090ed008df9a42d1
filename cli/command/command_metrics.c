// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/farm/daemon_call.h"
#include "cli/program/options.h"
#include "cli/terminal/print.h"
#include "core/wire/metrics_text.h"

#include <stdio.h>
#include <stdlib.h>

enum exit_status command_metrics(const struct options *options, struct error *error)
{
    struct message reply;
    enum exit_status status = daemon_call(options, "daemon.metrics", NULL, &reply, error);
    char *text = NULL;

    if (status != EXIT_STATUS_DONE) return status;
    if (options->json)
        print_json(&reply.body);
    else if ((text = metrics_text_format(&reply.body, error)))
        fputs(text, stdout);
    else
        status = EXIT_STATUS_FAILED;
    free(text);
    message_finish(&reply);
    return status;
}
