// SPDX-License-Identifier: Apache-2.0
#include "cli/command/commands.h"
#include "cli/program/options.h"

#include <stdio.h>

enum exit_status command_version(const struct options *options, struct error *error)
{
    printf(options->json ? "{\"version\":\"%s\"}\n" : "march %s\n", MARCHD_VERSION);
    return EXIT_STATUS_DONE;
}
